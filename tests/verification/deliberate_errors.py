# SPDX-License-Identifier: BSD-2-Clause
"""Deliberate errors: one change of the source each, for each contact law and scheme. Each must make a counted line of the manual
fail; otherwise, the manual does not check what it claims to check."""
from dataclasses import dataclass

MODEL = "contact/model/model.cpp"
SYSTEM = "contact/stepping/step_system.cpp"
STATE = "contact/stepping/modal_state.cpp"
BLOCK = "contact/stepping/look_ahead_block.cpp"
TABLE_STEPPER = "contact/table/table_stepper.cpp"
MODAL_TABLE = "contact/table/modal_table.cpp"
EQUILIBRIUM = "contact/static/equilibrium.cpp"


@dataclass(frozen=True)
class Error:
    """A change of one place in `file`, which contains `right` exactly once. `cases` are those of the manual that must notice it;
    `programs` are the targets that must be built again.
    """

    scheme: str
    kind: str  # force, sign, R, mode or step
    what: str
    file: str
    right: str
    wrong: str
    cases: tuple
    programs: tuple = ("ricochet-contact",)


# The first elastic mode of each body.
IS_FIRST = "omega > 0 && (n == 0 || model.omega(n - 1) == 0)"

COMPLIANT = ("rods", "two_balls", "falling_mass")
IMPULSE = ("rods", "falling_mass")
TABLES = ("rods_analytic", "rods")
STATIC = ("ball_at_rest",)
FRICTION = ("cattaneo", "oblique")

KERNEL = ("ricochet-kernel",)

ERRORS = (
    Error(
        "modes",
        "stiffness",
        "the shear modulus is 1.01 times too large on the diagonal",
        "src/elasticity/assemble.cpp",
        "material.mu * h.trace();",
        "1.01 * material.mu * h.trace();",
        ("box", "flexibility"),
        KERNEL,
    ),
    Error(
        "modes",
        "mode",
        "the lowest elastic mode takes the shape of the next",
        "src/modes/mode_set.cpp",
        "shape.rightCols(vectors.cols()) = vectors;",
        "shape.rightCols(vectors.cols()) = vectors;\n"
        "  if (first == 0 && vectors.cols() > 1) shape.col(rigid) = shape.col(rigid + 1);",
        ("bars",),
        KERNEL,
    ),
    Error(
        "modes",
        "R",
        "R still contains a tenth of the modes that are kept",
        "src/modes/residual.cpp",
        "response.noalias() -= other * kept.inverse(kept.others).asDiagonal() * other.transpose();",
        "response.noalias() -= 0.9 * other * kept.inverse(kept.others).asDiagonal() * other.transpose();",
        ("flexibility",),
        KERNEL,
    ),
    Error(
        "modes",
        "force",
        "the load of a patch is 1.02 times too large",
        "src/surface/patches.cpp",
        "w / surface.area[k]});",
        "1.02 * w / surface.area[k]});",
        ("flexibility",),
        KERNEL,
    ),
    Error(
        "compliant",
        "force",
        "bodies receive 1.02 times the force",
        BLOCK,
        "static_cast<T>(mean_(k) - held_force_(i))",
        "static_cast<T>(1.02 * mean_(k) - held_force_(i))",
        COMPLIANT,
    ),
    Error(
        "compliant",
        "force",
        "the mean force has weights 1/2, 1/4, 1/8",
        "contact/stepping/mean_force.hpp",
        "conserving_mean{0.625, 0.25, 0.125}",
        "conserving_mean{0.5, 0.25, 0.125}",
        ("two_balls", "orders"),
    ),
    Error(
        "all by modes",
        "sign",
        "the second body of a pair receives the force of the first",
        MODEL,
        "add(candidate, -weight)",
        "add(candidate, weight)",
        COMPLIANT,
    ),
    Error(
        "all by modes",
        "sign",
        "gravity acts upwards",
        MODEL,
        "block.momentum.transpose() * gravity;",
        "block.momentum.transpose() * -gravity;",
        ("falling_mass", "ball_at_rest"),
    ),
    Error(
        "compliant and static",
        "R",
        "half of R",
        MODEL,
        "R = PR * P.transpose();",
        "R = 0.5 * PR * P.transpose();",
        ("two_balls", "ball_at_rest", "orders"),
    ),
    Error(
        "compliant",
        "mode",
        "the first elastic mode of each body moves no point",
        SYSTEM,
        "out.set_step(n, omega, delta, options.step);",
        f"out.set_step(n, omega, delta, options.step);\n    if (compliant && {IS_FIRST}) out.B.col(n).setZero();",
        COMPLIANT,
    ),
    Error(
        "all by modes",
        "step",
        "modes move by 1.01 Δ in a step",
        SYSTEM,
        "mode_step(omega, decay, step);",
        "mode_step(omega, decay, 1.01 * step);",
        COMPLIANT,
    ),
    Error(
        "impulse",
        "force",
        "bodies receive 1.02 times the impulse",
        STATE,
        "const int active = push(impulse);",
        "const int active = push(1.02 * impulse);",
        IMPULSE,
    ),
    Error(
        "impulse",
        "sign",
        "impulses pull",
        STATE,
        "next_v -= push_;",
        "next_v += push_;",
        IMPULSE,
    ),
    Error(
        "impulse",
        "mode",
        "the first elastic mode of each body moves no point",
        SYSTEM,
        "out.set_step(n, omega, delta, options.step);",
        f"out.set_step(n, omega, delta, options.step);\n    if (!compliant && {IS_FIRST}) out.B.col(n).setZero();",
        IMPULSE,
    ),
    Error(
        "impulse",
        "step",
        "the mean velocity refers to 1.01 Δ",
        SYSTEM,
        "(out.b / options.step).asDiagonal()",
        "(out.b / (1.01 * options.step)).asDiagonal()",
        IMPULSE,
    ),
    Error(
        "impulse, exact instant",
        "step",
        "the touch is taken to be at the end of the step",
        "contact/stepping/event_stepper.cpp",
        "const double to = events_.first_closing(from, end, state_);",
        "const double to = end;",
        ("falling_mass",),
    ),
    Error(
        "table",
        "force",
        "the history contains 1.02 times the force",
        TABLE_STEPPER,
        "convolution_.push(next_force_);",
        "convolution_.push(1.02 * next_force_);",
        TABLES,
    ),
    Error(
        "table",
        "sign",
        "earlier forces pull the bodies into each other",
        TABLE_STEPPER,
        "free_u_ = next_u_ - convolution_.history();",
        "free_u_ = next_u_ + convolution_.history();",
        TABLES,
    ),
    Error(
        "table",
        "R",
        "half of R",
        MODAL_TABLE,
        "Matrix at_once = model.R;",
        "Matrix at_once = 0.5 * model.R;",
        TABLES,
    ),
    Error(
        "table",
        "mode",
        "the sums leave out the first elastic mode of each body",
        MODAL_TABLE,
        "series.push_back(compliant",
        "if (stiffness > 0 && (n == 0 || model.omega(n - 1) == 0)) continue;\n    series.push_back(compliant",
        TABLES,
    ),
    Error(
        "table",
        "step",
        "bodies move by 1.01 Δ in a step",
        TABLE_STEPPER,
        "const double t = static_cast<double>(k) * options_.step;",
        "const double t = 1.01 * static_cast<double>(k) * options_.step;",
        TABLES,
    ),
    Error(
        "static",
        "force",
        "forces are 1.02 times too large",
        EQUILIBRIUM,
        "const Vector f = loads.load - model_.B.transpose() * now_.force;",
        "now_.force *= 1.02;\n    const Vector f = loads.load - model_.B.transpose() * now_.force;",
        STATIC,
    ),
    Error(
        "static",
        "sign",
        "points yield to their force in the wrong direction through R",
        EQUILIBRIUM,
        "+ loads.s - model_.R * now_.force;",
        "+ loads.s + model_.R * now_.force;",
        STATIC,
    ),
    Error(
        "static",
        "mode",
        "the first elastic mode of each body does not yield",
        EQUILIBRIUM,
        "if (model.omega(n) > 0) flexibility(n) =",
        "if (model.omega(n) > 0 && n > 0 && model.omega(n - 1) > 0) flexibility(n) =",
        STATIC,
    ),
    Error(
        "friction",
        "force",
        "the coefficient is 1.05 times too large",
        "contact/stepping/slip.cpp",
        "return law.static_coefficient;",
        "return 1.05 * law.static_coefficient;",
        ("oblique",),
    ),
    Error(
        "friction",
        "sign",
        "friction drives the sliding",
        BLOCK,
        "rhs_(k) -= before(k, mean) + solvers.slip->belt()(kept_[k]);",
        "rhs_(k) = before(k, mean) + solvers.slip->belt()(kept_[k]) - rhs_(k);",
        ("oblique",),
    ),
    Error(
        "friction",
        "R",
        "R holds along the normals alone",
        MODEL,
        "R = (0.5 * (R + R.transpose())).eval();",
        "R = (0.5 * (R + R.transpose())).eval();\n      R.bottomRows(rows - points).setZero();\n"
        "      R.rightCols(rows - points).setZero();",
        FRICTION,
    ),
    Error(
        "friction",
        "mode",
        "the first elastic mode of each body does not move along the surface",
        SYSTEM,
        "out.set_step(n, omega, delta, options.step);",
        f"out.set_step(n, omega, delta, options.step);\n    if ({IS_FIRST}) out.B.col(n).tail(out.B.rows() - m).setZero();",
        ("oblique",),
    ),
    Error(
        "friction",
        "step",
        "slip of a step is 1.05 times too large",
        BLOCK,
        "rhs_(k) -= before(k, mean) + solvers.slip->belt()(kept_[k]);",
        "rhs_(k) = 1.05 * (rhs_(k) - before(k, mean) - solvers.slip->belt()(kept_[k]));",
        ("oblique",),
    ),
    Error(
        "friction at rest",
        "force",
        "the coefficient is 1.05 times too large",
        EQUILIBRIUM,
        "point.law.static_coefficient}",
        "1.05 * point.law.static_coefficient}",
        ("cattaneo",),
    ),
    Error(
        "friction at rest",
        "sign",
        "friction drives the sliding",
        EQUILIBRIUM,
        "r.tail(r.size() - m) -= slip.tail(r.size() - m);",
        "r.tail(r.size() - m) = slip.tail(r.size() - m) - r.tail(r.size() - m);",
        ("cattaneo",),
    ),
)
