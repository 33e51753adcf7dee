# SPDX-License-Identifier: BSD-2-Clause
"""The command `ricochet`: one module for each verb, with `add_arguments(parser)` and `run(options)`."""
import importlib
import io
import os
import signal
import sys
from types import FrameType, ModuleType

from ricochet.cli import unexpected
from ricochet.cli.options import Parser, Unprinted
from ricochet.errors import RicochetError, one_line

VERBS = {
    "run": "compute kernels and impact of a scene, and draw the result",
    "modes": "list and draw the modes of the bodies of a scene",
    "kernel": "compute the kernels of a scene: ricochet-kernel under mpirun",
    "impact": "compute the impact from the kernels: ricochet-contact",
    "plot": "draw a result as pictures",
    "report": "write a result as one web page",
    "sweep": "run a study: a scene over values of its keys",
    "tradeoff": "compare cost and error of the settings of a scene",
    "surfaces": "list and draw the surfaces of a drawing or mesh",
    "materials": "list the materials that a scene can name",
    "example": "copy a scene with its kernels, which runs at once",
    "import": "write a mesh or a body file from those of another program",
    "export": "write a body or a run for another program, or as a page to play",
    "batch": "run a study on a SLURM cluster",
}
MODULES = {"import": "import_"}  # a Python keyword cannot name a module
RESUMED = {"run", "modes", "sweep", "tradeoff"}  # verbs that skip finished work

DESCRIPTION = "Impact of elastic bodies from modal kernels."
EPILOG = "ricochet VERB --help describes a verb. A scene starts as a copy of one of the folders in meshes/."


class Interrupted(BaseException):
    """A signal requested the end of this process."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number


def interrupt(number: int, _: FrameType | None) -> None:
    raise Interrupted(number)


def module_of(verb: str) -> ModuleType:
    return importlib.import_module(f"ricochet.cli.{MODULES.get(verb, verb)}")


def root_parser() -> Parser:
    """The parser of the command without a verb: it lists the verbs, and none of their modules is imported."""
    parser = Parser(prog="ricochet", description=DESCRIPTION, epilog=EPILOG)
    verbs = parser.add_subparsers(title="verbs", metavar="VERB", required=True, parser_class=Parser)
    for name, purpose in VERBS.items():
        verbs.add_parser(name, help=purpose)
    return parser


def parser_of(verb: str) -> Parser:
    module = module_of(verb)
    parser = Parser(prog=f"ricochet {verb}", description=module.__doc__)
    module.add_arguments(parser)
    return parser


def dispatch(words: list[str]) -> int:
    verb = words[0] if words and not words[0].startswith("-") else None
    if verb is None:
        root_parser().parse_args(words or ["--help"])
    if verb not in VERBS:
        print(f"ricochet: {one_line(unexpected.verb_complaint(words, VERBS))}", file=sys.stderr)
        return 2
    heard = [
        n for n in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP) if signal.getsignal(n) != signal.SIG_IGN
    ]
    for number in heard:  # default handling during imports, in which numpy turns an interrupt into an error
        signal.signal(number, signal.SIG_DFL)
    module, parser = module_of(verb), parser_of(verb)
    for number in heard:
        signal.signal(number, interrupt)
    try:
        options, rest = parser.parse_known_args(getattr(module, "joined", list)(words[1:]))
        if rest and not hasattr(module, "PASSES_ON"):
            others = (parser_of(other) for other in VERBS if other != verb)
            parser.error(unexpected.complaint(parser, words[1:], rest, others))
        options.words = rest
        module.run(options)
        return 0
    except RicochetError as problem:
        return problem.report(f"ricochet {verb}")
    except Interrupted as signalled:
        more = "; the same command resumes the work" if verb in RESUMED else ""
        print(f"ricochet {verb}: interrupted{more}", file=sys.stderr)
        return 128 + signalled.number


def main(words: list[str] | None = None) -> int:
    """Runs a command line. Returns its exit status: 0; 1 after a failure; 2 after a mistake of the user."""
    if sys.stderr is None:  # closed: occupy its descriptor, so that no opened file gets it
        sys.stderr = open(os.devnull, "w")
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="surrogateescape")  # file names may contain any bytes
    words = sys.argv[1:] if words is None else words
    try:
        try:
            return dispatch(words)
        finally:
            print(end="", flush=True)
    except (OSError, Unprinted) as error:
        why = error.strerror if isinstance(error, OSError) else error
        name = " ".join(["ricochet", *words[:1]])
        print(f"{one_line(name)}: cannot write to standard output ({why})", file=sys.stderr)
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # for output that is still in the buffer
        return 1
