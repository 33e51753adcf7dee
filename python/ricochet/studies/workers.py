# SPDX-License-Identifier: BSD-2-Clause
"""Processes of ricochet-contact that answer requests in parallel (src/impact/batch.hpp)."""
import itertools
import json
import os
import selectors
import subprocess
from collections import deque
from collections.abc import Generator, Iterable, Iterator, Sequence
from typing import Any

from ricochet import programs

# While a process computes, its next request waits in the pipe, if the pipe certainly has room for it.
AHEAD, PIPE_BYTES = 2, 32768
READ_BYTES = 1 << 20
HISTORIES = b'"histories":'  # in an answer that records may follow

Reply = tuple[int, bytes, bytes]


class Worker:
    """A process of ricochet-contact that answers requests in order. It is restarted if it dies."""

    def __init__(self, command: Sequence[str], selector: selectors.DefaultSelector) -> None:
        self.command, self.selector = command, selector
        self.asked: deque[tuple[int, bytes]] = deque()  # sent, but not answered yet
        self.deaths = 0
        self.start()

    def start(self) -> None:
        self.rest = bytearray()  # of an incomplete answer
        self.line, self.size = b"", 0  # an answer whose records, of this size, are not complete yet
        self.process = subprocess.Popen(
            self.command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=os.environ | programs.ONE_THREAD,
            bufsize=0,
        )
        assert self.process.stdin and self.process.stdout
        self.requests, self.replies = self.process.stdin, self.process.stdout
        self.selector.register(self.replies, selectors.EVENT_READ, self)

    def fill(self, requests: Iterator[tuple[int, bytes]]) -> None:
        """Sends as many of `requests`, pairs of an index and a line, as may wait for the process."""
        while len(self.asked) < AHEAD and sum(len(line) for _, line in self.asked) < PIPE_BYTES:
            request = next(requests, None)
            if request is None:
                break
            self.ask(request)

    def ask(self, request: tuple[int, bytes]) -> None:
        self.asked.append(request)
        self.send(request[1])

    def send(self, line: bytes) -> None:
        try:
            self.requests.write(line)
        except BrokenPipeError:
            pass  # `answers` handles the end of its output

    def answers(self) -> Generator[Reply, None, None]:
        """Yields an index, an answer, a line of JSON, and the records that follow it, an HDF5 file or nothing.
        If the program dies twice on a request, the answer is {"died": true, …}. Such a request should be sent
        again later, because the program may have been killed."""
        found = os.read(self.replies.fileno(), READ_BYTES)
        if not found:
            yield from self.revive()
            return
        self.rest += found
        while True:
            if not self.line:
                line, end, rest = self.rest.partition(b"\n")
                if not end:
                    return
                self.line, self.rest = bytes(line), rest
                self.size = json.loads(self.line).get("histories", 0) if HISTORIES in self.line else 0
            if len(self.rest) < self.size:
                return
            answer = self.line, bytes(self.rest[: self.size])
            del self.rest[: self.size]
            self.line, self.deaths = b"", 0
            yield self.asked.popleft()[0], *answer

    def revive(self) -> Generator[Reply, None, None]:
        self.close()
        status = self.process.wait()
        self.deaths += 1
        if self.deaths == 2 and self.asked:
            self.deaths = 0
            answer = {"status": 1, "error": f"ricochet-contact ended with status {status}", "died": True}
            yield self.asked.popleft()[0], json.dumps(answer).encode(), b""
        self.start()
        for _, line in self.asked:
            self.send(line)

    def close(self) -> None:
        self.selector.unregister(self.replies)
        self.requests.close()
        self.replies.close()

    def dismiss(self) -> None:
        """Ends the process: by a signal if requests are unanswered, otherwise by the end of its input."""
        if self.asked:
            self.process.terminate()
        self.close()


def in_parallel(jobs: int, command: Sequence[str], requests: Iterable[Any]) -> Generator[Reply, None, None]:
    """Distributes requests, Python objects, to at most `jobs` processes. Yields (index, answer as a line of
    JSON, records)."""
    waiting = ((index, json.dumps(request).encode() + b"\n") for index, request in enumerate(requests))
    with selectors.DefaultSelector() as selector:
        workers = []
        try:
            for request in itertools.islice(waiting, jobs):
                workers.append(Worker(command, selector))
                workers[-1].ask(request)
            for worker in workers:
                worker.fill(waiting)
            while any(worker.asked for worker in workers):
                for key, _ in selector.select():
                    yield from key.data.answers()
                    key.data.fill(waiting)
        finally:
            for worker in workers:
                worker.dismiss()
            for worker in workers:
                worker.process.wait()
