# SPDX-License-Identifier: BSD-2-Clause
"""Deliberate errors in each contact law and scheme: a wrong force, a wrong sign, a wrong R, a lost mode, a wrong Δ. Each must make a
line of the validation manual fail (errors_caught.py)."""
from typing import NamedTuple

KINDS = ("force", "sign", "R", "mode", "Δ")
SCHEMES = {
    "two bodies": "elastic bodies against each other",
    "obstacle": "a body against a rigid obstacle",
    "conserving": "`compliant` with a mean of the forces",
    "backward Euler": "`compliant` with the force at the end of the step",
    "blocks": "steps in look-ahead blocks",
    "free flight": "adaptive steps: one step from sample to sample while nothing can touch",
    "jump": "`impulse` with the velocity jump, as printed in the paper",
    "difference": "`impulse` with the difference quotient over a step",
    "exact instants": "`impulse` at the instants at which points close",
    "compliant table": "sampled responses under `compliant`",
    "impulse table": "sampled responses under `impulse`",
    "static": "equilibrium, without time",
    "friction": "Coulomb's law",
    "moving obstacle": "a rigid obstacle that moves along its surface",
    "moving support": "prescribed motion of a support",
    "gravity": "weight",
}


class Error(NamedTuple):
    """Replacing `right`, which occurs once in `file`, by `wrong` makes a line fail in each of `cases`."""

    scheme: str
    kind: str
    what: str
    file: str
    right: str
    wrong: str
    cases: tuple


BODIES, ROWS = "contact/bodies/bodies.cpp", "contact/rows/rows.cpp"
BLOCK = "contact/stepping/look_ahead_block.cpp"
LAW, SLIP = "contact/law/contact_law.cpp", "contact/law/slip.cpp"
BLOCK_SYSTEM, POINTS = "contact/stepping/block_system.cpp", "contact/stepping/block_points.cpp"
MOTION = "contact/stepping/block_motion.cpp"
IMPULSES = "contact/stepping/impulse_problem.cpp"
TABLE, SAMPLED = "contact/table/table_stepper.cpp", "contact/table/modal_table.cpp"
STATIC, RESPONSE = "contact/static/equilibrium.cpp", "contact/stepping/forced_response.cpp"
SHAPE = "add_row(of_modes, i, shape, rows.B.row(i).data() + block.first_mode);"
FIRST_LOST = "first elastic mode of each body lost"

ERRORS = (
    # Laws: what meets what
    Error(
        "two bodies",
        "force",
        "force on the second body 2 % too large",
        ROWS,
        "for (const auto& [candidate, weight] : point.of_b) add(candidate, -weight);",
        "for (const auto& [candidate, weight] : point.of_b) add(candidate, -1.02 * weight);",
        ("rods", "two_balls"),
    ),
    Error(
        "two bodies",
        "sign",
        "the second body is pulled",
        ROWS,
        "for (const auto& [candidate, weight] : point.of_b) add(candidate, -weight);",
        "for (const auto& [candidate, weight] : point.of_b) add(candidate, weight);",
        ("rods", "two_balls"),
    ),
    Error(
        "two bodies",
        "R",
        "R halved",
        ROWS,
        "const double value = 0.5 * along(P, j, rows.yielded.data());",
        "const double value = 0.25 * along(P, j, rows.yielded.data());",
        ("two_balls",),
    ),
    Error(
        "two bodies",
        "mode",
        FIRST_LOST,
        ROWS,
        SHAPE,
        SHAPE
        + """
      for (int n = block.first_mode + 1; n < block.first_mode + block.modes; ++n)
        if (bodies.omega(n - 1) == 0 && bodies.omega(n) > 0) rows.B(i, n) = 0;""",
        ("rods",),
    ),
    Error(
        "obstacle",
        "force",
        "force on the body 2 % too large",
        ROWS,
        "for (const auto& [candidate, weight] : point.of_a) add(candidate, weight);",
        "for (const auto& [candidate, weight] : point.of_a) add(candidate, pair.b < 0 ? 1.02 * weight : weight);",
        ("bouncing_bar",),
    ),
    Error(
        "obstacle",
        "sign",
        "normal into the obstacle reversed",
        ROWS,
        "for (const auto& [candidate, weight] : point.of_a) add(candidate, weight);",
        "for (const auto& [candidate, weight] : point.of_a) add(candidate, pair.b < 0 ? -weight : weight);",
        ("falling_mass", "bouncing_bar"),
    ),
    # Contact steps
    Error(
        "conserving",
        "force",
        "recorded mean force 2 % too large",
        BLOCK,
        "    force(i) = law.force()(k);",
        "    force(i) = 1.02 * law.force()(k);",
        ("rods", "two_balls"),
    ),
    Error(
        "conserving",
        "sign",
        "the earlier forces subtracted from the mean",
        LAW,
        "p.force.head(n) = weights.start * p.now.head(n) + weights.before * p.before.head(n);",
        "p.force.head(n) = -weights.start * p.now.head(n) - weights.before * p.before.head(n);",
        ("two_balls",),
    ),
    Error(
        "conserving",
        "R",
        "R halved in the system of the step",
        POINTS,
        "S_mean_.begin(n) = conserving_mean.end * M + R;",
        "S_mean_.begin(n) = conserving_mean.end * M + 0.5 * R;",
        ("two_balls",),
    ),
    Error(
        "backward Euler",
        "force",
        "λ⁺ 2 % too large",
        LAW,
        "  p.force.head(n) += weights.end * p.end.head(n);",
        "  p.force.head(n) += (euler ? 1.02 : 1) * weights.end * p.end.head(n);",
        ("falling_mass",),
    ),
    Error(
        "backward Euler",
        "R",
        "R halved in the system of the step",
        POINTS,
        "      S += R;",
        "      S += 0.5 * R;",
        ("rods",),
    ),
    Error(
        "blocks",
        "force",
        "held force 2 % too large",
        MOTION,
        "load_[n] -= held.on_modes[n];",
        "load_[n] -= 1.02 * held.on_modes[n];",
        ("rods",),
    ),
    Error(
        "blocks",
        "sign",
        "held force reversed on the rigid modes",
        MOTION,
        "const double load = forcing.load(n) - held.on_rigid[r];",
        "const double load = forcing.load(n) + held.on_rigid[r];",
        ("rods",),
    ),
    Error(
        "blocks",
        "R",
        "R λ⁺ halved at the end of each step",
        BLOCK,
        "    kept_.u(k, l) -= law.yielded()(k) - kept_.yielded()(k);",
        "    kept_.u(k, l) -= 0.5 * (law.yielded()(k) - kept_.yielded()(k));",
        ("two_balls",),
    ),
    Error(
        "blocks",
        "mode",
        "lowest elastic mode lost in the prediction",
        BLOCK_SYSTEM,
        "    for (int n : ascending) B[i * modes + n] = static_cast<T>(model.B(i, n));",
        "    for (int n : ascending) B[i * modes + n] = static_cast<T>(n == ascending[0] ? 0 : model.B(i, n));",
        ("rods",),
    ),
    Error(
        "blocks",
        "Δ",
        "lags of the convolution 1 % too long",
        "contact/stepping/block_matrices.cpp",
        "static_cast<double>(d + 1) * step).c;",
        "static_cast<double>(d + 1) * 1.01 * step).c;",
        ("rods",),
    ),
    Error(
        "free flight",
        "sign",
        "weight reversed",
        "contact/stepping/free_flight.cpp",
        "const double g = piece.load(n) - system.stiffness(n) * state.q(n), v = state.v(n);",
        "const double g = -piece.load(n) - system.stiffness(n) * state.q(n), v = state.v(n);",
        ("falling_mass",),
    ),
    Error(
        "free flight",
        "Δ",
        "jump 1 % too long",
        "contact/stepping/free_flight.cpp",
        "over_.set_step(n, system.model->omega(n), system.model->decay(n), steps * step_);",
        "over_.set_step(n, system.model->omega(n), system.model->decay(n), 1.01 * steps * step_);",
        ("falling_mass",),
    ),
    # Impulses
    Error(
        "jump",
        "force",
        "impulse 2 % too small",
        IMPULSES,
        "    *out = B * B.transpose();",
        "    *out = 1.02 * B * B.transpose();",
        ("rods",),
    ),
    Error(
        "jump",
        "sign",
        "restitution reversed",
        IMPULSES,
        "rhs_(j) = (1 + options_.restitution)",
        "rhs_(j) = (1 - options_.restitution)",
        ("falling_mass",),
    ),
    Error(
        "jump",
        "Δ",
        "force of an impulse over a step 1 % too long",
        "contact/stepping/impulse_stepper.cpp",
        "next_force_ /= options_.step;",
        "next_force_ /= 1.01 * options_.step;",
        ("rods",),
    ),
    Error(
        "difference",
        "force",
        "impulse 2 % too small",
        IMPULSES,
        "    *out = B * (system.b / options.step).asDiagonal() * B.transpose();",
        "    *out = 1.02 * B * (system.b / options.step).asDiagonal() * B.transpose();",
        ("rods",),
    ),
    Error(
        "difference",
        "sign",
        "approach reversed",
        IMPULSES,
        "    x = &moved;",
        "    moved = -moved;\n    x = &moved;",
        ("rods",),
    ),
    Error(
        "difference",
        "Δ",
        "quotient over a step 1 % too long",
        IMPULSES,
        "    moved /= options_.step;",
        "    moved /= 1.01 * options_.step;",
        ("rods",),
    ),
    Error(
        "exact instants",
        "force",
        "recorded impulse 2 % too large",
        "contact/stepping/event_stepper.cpp",
        "    impulse_ += next_force_;",
        "    impulse_ += 1.02 * next_force_;",
        ("falling_mass",),
    ),
    Error(
        "exact instants",
        "sign",
        "impulse reversed",
        "contact/stepping/event_stepper.cpp",
        "    state_.strike(next_force_, work);",
        "    state_.strike(-next_force_, work);",
        ("falling_mass",),
    ),
    Error(
        "exact instants",
        "Δ",
        "motion to the instant of closing 1 % too long",
        "contact/stepping/event_stepper.cpp",
        "state_.forcing.interval(from, to, state_.now);",
        "state_.forcing.interval(from, to + 0.01 * (to - from), state_.now);",
        ("falling_mass",),
    ),
    # Tables
    Error(
        "compliant table",
        "force",
        "past force 2 % too large",
        TABLE,
        "  convolution_.push(next_force_);",
        "  convolution_.push((options_.scheme == Scheme::compliant ? 1.02 : 1) * next_force_);",
        ("rods_analytic",),
    ),
    Error(
        "compliant table",
        "sign",
        "effect of earlier forces reversed",
        TABLE,
        "    law_.free = next_u_ - convolution_.history();",
        "    law_.free = next_u_ + convolution_.history();",
        ("rods_analytic",),
    ),
    Error(
        "compliant table",
        "mode",
        "lowest elastic mode lost in the samples",
        SAMPLED,
        "    column.push_back(n);",
        "    column.push_back(n);\n    if (n > 0 && model.omega(n - 1) == 0 && stiffness > 0) { series.pop_back(); column.pop_back(); }",
        ("rods",),
    ),
    Error(
        "compliant table",
        "Δ",
        "samples of the modes 1 % too far apart",
        SAMPLED,
        "    const ModeStep by = mode_step(model.omega(n), model.decay(n), options.step);",
        "    const ModeStep by = mode_step(model.omega(n), model.decay(n), 1.01 * options.step);",
        ("rods",),
    ),
    Error(
        "impulse table",
        "force",
        "past impulse 2 % too large",
        TABLE,
        "  convolution_.push(next_force_);",
        "  convolution_.push((options_.scheme == Scheme::impulse ? 1.02 : 1) * next_force_);",
        ("rods_analytic",),
    ),
    Error(
        "impulse table",
        "sign",
        "effect of earlier impulses on the rate reversed",
        TABLE,
        "  rate_ -= convolution_.history().tail(m);",
        "  rate_ += convolution_.history().tail(m);",
        ("rods_analytic",),
    ),
    Error(
        "impulse table",
        "Δ",
        "force of an impulse over a step 1 % too long",
        TABLE,
        "if (impulse) next_force_ /= options_.step;",
        "if (impulse) next_force_ /= 1.01 * options_.step;",
        ("rods_analytic",),
    ),
    # At rest
    Error(
        "static",
        "force",
        "loads 2 % too large",
        STATIC,
        "now_.imbalance = balance_.solve(r, loads.load(rigid), now_.force, rho_);",
        "now_.imbalance = balance_.solve(r, 1.02 * loads.load(rigid), now_.force, rho_);",
        ("ball_at_rest", "belt"),
    ),
    Error(
        "static",
        "sign",
        "gaps reversed",
        STATIC,
        "    r.head(m) -= model_.gap;",
        "    r.head(m) += model_.gap;",
        ("ball_at_rest",),
    ),
    Error(
        "static",
        "R",
        "R halved",
        STATIC,
        "model.B.transpose() + model.R;",
        "model.B.transpose() + 0.5 * model.R;",
        ("ball_at_rest",),
    ),
    # Friction
    Error(
        "friction",
        "force",
        "coefficient 2 % too large",
        SLIP,
        "if (law.static_coefficient == law.dynamic_coefficient) return law.static_coefficient;",
        "if (law.static_coefficient == law.dynamic_coefficient) return 1.02 * law.static_coefficient;",
        ("belt",),
    ),
    Error(
        "friction",
        "sign",
        "displacement before the step added to the slip",
        LAW,
        "p.right(k) = p.u(k) - p.start(k) - p.belt(k);",
        "p.right(k) = p.u(k) + p.start(k) - p.belt(k);",
        ("belt",),
    ),
    Error(
        "friction",
        "Δ",
        "speed of the slip over half a step",
        SLIP,
        "next_speed_(f) = std::hypot(slip[0], slip[1]) / step_;",
        "next_speed_(f) = std::hypot(slip[0], slip[1]) / (0.5 * step_);",
        ("belt",),
    ),
    Error(
        "moving obstacle",
        "sign",
        "the obstacle moves backwards",
        SLIP,
        "belt_ += (belt.history.at(to) - belt.history.at(from)) * belt.slide;",
        "belt_ -= (belt.history.at(to) - belt.history.at(from)) * belt.slide;",
        ("belt",),
    ),
    Error(
        "moving obstacle",
        "Δ",
        "motion over a step 1 % too long",
        SLIP,
        "to = static_cast<double>(k) * step_;",
        "to = (static_cast<double>(k) + 0.01) * step_;",
        ("belt",),
    ),
    Error(
        "moving support",
        "sign",
        "the support moves the other way",
        "contact/model/forcing.cpp",
        "out.lift = matrix(motion.participation, 3, block.modes).transpose() * along;",
        "out.lift = -matrix(motion.participation, 3, block.modes).transpose() * along;",
        ("driven_rod",),
    ),
    Error(
        "moving support",
        "mode",
        "lowest mode not moved",
        "contact/model/forcing.cpp",
        "      out.displacement += B * out.lift;  // Ψ = (Ψ − ΦΓ) + ΦΓ",
        "      out.displacement += B * out.lift;  // Ψ = (Ψ − ΦΓ) + ΦΓ\n      out.lift(0) = 0;",
        ("driven_rod",),
    ),
    Error(
        "moving support",
        "R",
        "static part of the modes that are left out halved",
        "contact/model/forcing.cpp",
        "out.displacement = P * (matrix(residual, P.cols(), 3) * along).eval();",
        "out.displacement = 0.5 * P * (matrix(residual, P.cols(), 3) * along).eval();",
        ("driven_rod",),
    ),
    Error(
        "moving support",
        "Δ",
        "time of the motion 1 % ahead",
        RESPONSE,
        "  points(out.to, out.s, out.rate);",
        "  points(1.01 * out.to, out.s, out.rate);",
        ("driven_rod",),
    ),
    Error(
        "gravity",
        "force",
        "weight 2 % too large",
        BODIES,
        "out.load.segment(first, n) = block.momentum.transpose() * gravity;",
        "out.load.segment(first, n) = 1.02 * block.momentum.transpose() * gravity;",
        ("falling_mass",),
    ),
    Error(
        "gravity",
        "sign",
        "weight reversed",
        BODIES,
        "out.load.segment(first, n) = block.momentum.transpose() * gravity;",
        "out.load.segment(first, n) = -block.momentum.transpose() * gravity;",
        ("falling_mass",),
    ),
)

SHARED = "the model gives every scheme the same modes and the same R (see two bodies)"
# Why a scheme has no error of a kind.
NONE = {
    ("two bodies", "Δ"): "a law has no step; each scheme has its own",
    ("obstacle", "Δ"): "a law has no step; each scheme has its own",
    ("obstacle", "R"): SHARED,
    ("obstacle", "mode"): SHARED,
    ("conserving", "mode"): SHARED,
    ("conserving", "Δ"): "the mean has fixed weights; Δ enters through the motion of the modes (see blocks)",
    (
        "backward Euler",
        "sign",
    ): "differs from `conserving` in its weights (1, 0, 0) alone, which have no sign to lose",
    ("backward Euler", "mode"): SHARED,
    ("backward Euler", "Δ"): "Δ enters through the motion of the modes (see blocks)",
    ("free flight", "force"): "no contact force acts",
    ("free flight", "R"): "no contact force acts on R",
    ("free flight", "mode"): SHARED,
    ("jump", "R"): "the law does not contain R",
    ("jump", "mode"): SHARED,
    ("difference", "R"): "the law does not contain R",
    ("difference", "mode"): SHARED,
    ("exact instants", "R"): "the law does not contain R",
    ("exact instants", "mode"): "the body of Figure 9 is rigid; otherwise " + SHARED,
    (
        "compliant table",
        "R",
    ): "not caught: R halved in the samples changed no line, because the rods of the short cases keep 100 of 101 modes",
    ("impulse table", "R"): "the law does not contain R",
    ("impulse table", "mode"): "the samples are made as for `compliant`",
    ("static", "mode"): SHARED,
    ("static", "Δ"): "there is no time",
    ("friction", "R"): SHARED,
    ("friction", "mode"): SHARED,
    ("moving obstacle", "force"): "a rigid obstacle has no force of its own; its motion enters the slip",
    ("moving obstacle", "R"): "a rigid obstacle has no flexibility",
    ("moving obstacle", "mode"): "a rigid obstacle has no modes",
    ("moving support", "force"): "the support prescribes a motion, not a force",
    ("gravity", "R"): "its static part at the contact is far below every other length in the short cases",
    ("gravity", "mode"): SHARED,
    ("gravity", "Δ"): "the weight is constant; the schemes integrate it (see free flight and exact instants)",
}


def check(root):
    """Raises ValueError if a text does not occur exactly once in its file, or a kind has neither an error nor a reason."""
    for error in ERRORS:
        count = (root / error.file).read_text().count(error.right)
        if count != 1:
            raise ValueError(
                f"{error.scheme}, {error.kind}: occurs {count} times in {error.file}: {error.right}"
            )
    covered = {(error.scheme, error.kind) for error in ERRORS}
    for scheme in SCHEMES:
        for kind in KINDS:
            if ((scheme, kind) in covered) == ((scheme, kind) in NONE):
                raise ValueError(
                    f"{scheme}, {kind}: needs an error, or a reason why there is none, and not both"
                )
