# SPDX-License-Identifier: BSD-2-Clause
"""Instruments: a body that sounds and a mallet that strikes it at many places, as one block of bytes for the player
(player/instrument.hpp)."""
from __future__ import annotations

import contextlib
import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ricochet import _core
from ricochet.arrays import Array
from ricochet.errors import InputError
from ricochet.interchange.rotations import angles_of, rotation_of, turn_between
from ricochet.kernel import Kernel
from ricochet.progress import Progress
from ricochet.scene import Scene

VERSION = 2
MOST_PLACES = 128
MOST_POINTS = 8  # of a place other than that of the scene, those of smallest gap
OWN_POINTS = 64  # of the place of the scene
LONGEST_BLOW_S = 0.1  # from the start of the scene to the end of the contact
BLOCK = 1024  # steps
HEARD_FROM_HZ = 20.0
CLEARANCE = 1e-3  # initial, from which the gap is closed, relative to the size of the mallet
LIGHT = 0.1  # mass of the light mallet, as a multiple of the scene's
LAYERS_S = {"medium": 2e-3, "soft": 5e-3}  # durations of a blow through a layer on the tip [s]


@dataclass(frozen=True)
class Mallet:
    name: str
    mass: float = 1.0  #: as a multiple of the scene's
    layer: float = 0.0  #: compliance: thickness over Young's modulus [m³/N]


@dataclass(frozen=True)
class Place:
    """m contact points of the mallet in front of a point of the body. N modes of the body, P of the mallet."""

    point: Array  #: (3) world [m]
    normal: Array  #: (3) out of the body, world
    rate: Array  #: (P) modal velocity of the mallet at 1 m/s
    gap: Array  #: (m) [m]
    bulge: Array  #: (m) by which patches bulge beyond their means [m]
    area: Array  #: (m) [m²]
    rows: Array  #: (m,N+P) of B
    flexibility: Array  #: (m,m) R [m/N]


@dataclass(frozen=True)
class Instrument:
    body: str
    channels: list[str]  #: names of the left and of the right channel
    contact_rate_hz: float
    omega: Array
    decay: Array
    sound: Array  #: (2,N) velocity of the channels for unit modal velocities
    mallet_omega: Array
    mallet_decay: Array
    mallets: list[Mallet]
    places: list[Place]  #: the first one is that of the scene
    speed: float  #: of the mallet in the scene [m/s]

    def block(self) -> bytes:
        """The bytes that the player reads."""
        names = "".join(mallet.name.replace("\n", " ") + "\n" for mallet in self.mallets).encode()
        counts = [len(self.omega), len(self.mallet_omega), len(self.mallets), len(self.places), len(names)]
        points = [len(place.gap) for place in self.places]
        text = struct.pack(f"<{len(points)}I", *points) + names
        text += bytes(-(36 + len(text)) % 8)
        numbers: list[Any] = [self.contact_rate_hz, self.omega, self.decay, self.sound, self.mallet_omega]
        numbers += [self.mallet_decay, [[mallet.mass, mallet.layer] for mallet in self.mallets]]
        for place in self.places:
            numbers += [place.point, place.normal, place.rate, place.gap, place.bulge, place.area]
            numbers += [place.rows, place.flexibility]
        data = b"".join(np.asarray(values, "<f8").tobytes() for values in numbers)
        length = 36 + len(text) + len(data)
        return struct.pack("<8s7I", b"ricochet", VERSION, *counts, length) + text + data


class Blow:
    """The pair of a scene in which a mallet strikes a body, without friction."""

    def __init__(self, scene: Scene, body: str | None = None) -> None:
        """body: that sounds; default: the one with receivers, otherwise the one with supports.

        Raises InputError for a scene without such a pair."""
        self.scene, table = scene, scene.resolved
        bodies = table.get("bodies", {})
        pairs = [
            pair
            for pair in table.get("contact", {}).get("pair", [])
            if set(pair["between"]) <= bodies.keys() and body in (None, *pair["between"])
        ]
        if not pairs:
            wanted = f"no pair of {body!r} with another body" if body else "no pair of two bodies"
            raise InputError(f"{scene.file.name}: contact: has {wanted}, so no mallet can strike it.")
        self.pair: dict[str, Any] = {key: value for key, value in pairs[0].items() if key != "friction"}
        receivers = table.get("output", {}).get("receiver", [])
        heard = [receiver["body"] for receiver in receivers]
        between: list[str] = self.pair["between"]
        self.body = body or max(between, key=lambda name: (name in heard, bool(bodies[name].get("support"))))
        self.mallet = next(name for name in between if name != self.body)
        self.names = sorted(between)
        self.bodies = {name: bodies[name] for name in self.names}
        self.first = between[0] == self.mallet  # whether normals point out of the mallet
        self.receivers = [receiver for receiver in receivers if receiver["body"] == self.body]
        self.table = {key: table[key] for key in ("title", "modes", "time") if key in table}

    def scene_with(self, changes: dict[str, Any], pair: dict[str, Any]) -> Scene:
        """The scene with other keys of these bodies and of the pair."""
        bodies = {name: self.bodies[name] | changes.get(name, {}) for name in self.names}
        return Scene(self.table | {"bodies": bodies, "contact": pair}, self.scene.file.parent)


class Striking:
    """A blow with its kernels: contact systems of the mallet in front of places of the body."""

    def __init__(self, blow: Blow, kernels: Mapping[str, Kernel]) -> None:
        self.blow = blow
        self.kernels = {name: kernels[name] for name in blow.names}
        self.modes, first = {}, 0
        for name, kernel in self.kernels.items():
            self.modes[name] = slice(first, first + len(kernel.angular_frequency))
            first += len(kernel.angular_frequency)

        self.cores = [kernel._core for kernel in self.kernels.values()]

    def scene(self, mallet: dict[str, Any], gap: float | None) -> Scene:
        """The scene with these keys of the mallet, while the body is at rest."""
        blow = self.blow
        still = {"velocity": [0.0, 0.0, 0.0], "angular_velocity": [0.0, 0.0, 0.0]}
        pair = blow.pair | ({} if gap is None else {"gap": gap})
        return blow.scene_with({blow.body: still, blow.mallet: still | mallet}, pair)

    def system(
        self, mallet: dict[str, Any], gap: float | None, pickups: list[_core.Pickup]
    ) -> dict[str, Any]:
        """The contact system of this scene."""
        return _core.contact_system(self.scene(mallet, gap)._for_impact(), self.cores, pickups)

    def power(self, mallet: dict[str, Any], system: dict[str, Any]) -> Array:
        """(N) Squared velocities that the blow of the scene leaves to the modes of the body, |∫ Bᵀ λ e^{−iωt} dt|²;
        0 for those below hearing, which include rigid motion. A long blow excites the high ones little."""
        time = self.blow.scene.resolved["time"]
        rate = float(time.get("contact_rate_hz") or time["rate_hz"])
        omega = self.kernels[self.blow.body].angular_frequency
        rows = system["B"][:, self.modes[self.blow.body]]
        simulation = _core.Simulation(self.scene(mallet, None)._for_impact(), self.cores, [])
        out = np.zeros(len(omega), complex)
        for first in range(0, int(LONGEST_BLOW_S * rate), BLOCK):
            force, total = np.empty((BLOCK, len(rows))), np.empty(BLOCK)
            simulation.step_block(BLOCK, np.empty((BLOCK, 0)), total, force, None, None)
            moments = (first + np.arange(BLOCK)) / rate
            out += (np.exp(-1j * np.outer(omega, moments)) * (force @ rows).T).sum(axis=1) / rate
            if not total.any() and out.any():
                break
        return np.where(omega > 2 * np.pi * HEARD_FROM_HZ, np.abs(out) ** 2, 0)

    def place(self, system: dict[str, Any], point: Array, normal: Array, most: int) -> Place:
        """The place of a system, with the `most` contact points of smallest gap."""
        chosen = np.sort(np.argsort(system["gap"], kind="stable")[:most])
        body, mallet = self.modes[self.blow.body], self.modes[self.blow.mallet]
        rows = system["B"][chosen]
        return Place(
            point=point,
            normal=normal,
            rate=system["rate"][mallet],
            gap=system["gap"][chosen],
            bulge=system["bulge"][chosen],
            area=system["area"][chosen],
            rows=np.hstack([rows[:, body], rows[:, mallet]]),
            flexibility=system["R"][np.ix_(chosen, chosen)],
        )


def instrument_of(
    scene: Scene, kernels: Mapping[str, Kernel], body: str | None = None, most: int = MOST_PLACES
) -> Instrument:
    """The instrument of a scene in which two bodies meet. Places are the candidates of the kernel of `body`
    that the other body, the mallet, can reach with the same tip as in the scene.

    body: which of them sounds; default: the one with receivers, otherwise the one with supports.
    most: largest number of places besides that of the scene.

    Raises InputError for a scene without such a pair, and for kernels that do not fit.
    """
    blow = Blow(scene, body)
    striking = Striking(blow, kernels)
    struck, hammer = kernels[blow.body], kernels[blow.mallet]
    velocities = {name: np.array(blow.bodies[name].get("velocity", [0, 0, 0]), float) for name in blow.names}
    velocity = velocities[blow.mallet] - velocities[blow.body]
    speed = float(np.linalg.norm(velocity))
    channels = channels_of(blow, struck)
    pickups = [pickup for channel in channels for _, pickup in channel]
    system = striking.system({"velocity": velocity}, None, pickups)
    tip = Tip(striking, system)
    if speed == 0:
        velocity, speed = tip.out, 1.0
        system = striking.system({"velocity": velocity}, None, pickups)
    own = striking.place(system, tip.point, -tip.out, OWN_POINTS)
    own = replace(own, rate=own.rate / speed)
    places = [own, *tip.elsewhere(struck, most)]
    power = striking.power({"velocity": velocity}, system)
    names, sound = loudest(channels, system["pickups"][:, striking.modes[blow.body]], power)
    time = scene.resolved["time"]
    return Instrument(
        body=blow.body,
        channels=names,
        contact_rate_hz=float(time.get("contact_rate_hz") or time["rate_hz"]),
        omega=struck.angular_frequency,
        decay=struck.decay_rate,
        sound=sound,
        mallet_omega=hammer.angular_frequency,
        mallet_decay=hammer.decay_rate,
        mallets=mallets_of(blow.mallet, hammer.mass, float(own.area.mean())),
        places=places,
        speed=speed,
    )


def mallets_of(name: str, mass: float, area: float) -> list[Mallet]:
    """The mallet of the scene, with soft layers on its tip, and lighter. A layer on one contact point makes a
    blow last π √(m r) with r = layer/area."""
    layers = {text: (seconds / np.pi) ** 2 / mass * area for text, seconds in LAYERS_S.items()}
    soft = [Mallet(f"{name}, {text} tip", 1.0, layer) for text, layer in layers.items()]
    return [Mallet(name), *soft, Mallet(f"{name}, light", LIGHT)]


def channels_of(blow: Blow, kernel: Kernel) -> list[list[tuple[str, _core.Pickup]]]:
    """What can be heard as the left and as the right channel, by name: the receivers of the scene's sound along
    its direction; otherwise the axes of the first two receivers; otherwise the candidate farthest from the
    middle of all candidates, along its normal. A single channel is heard on both sides."""
    turned = rotation_of(blow.bodies[blow.body].get("rotate_deg", [0, 0, 0]))

    def heard(receiver: dict[str, Any], name: str, direction: Any) -> tuple[str, _core.Pickup]:
        """`direction` is in the axes of the receiver."""
        along = turned @ direction if receiver.get("axes") == "body" else direction
        return f"{receiver['name']} {name}", _core.Pickup(blow.body, receiver["name"], 0, list(along))

    sound = blow.scene.resolved["output"].get("sound")
    if sound and (chosen := [one for one in blow.receivers if one["name"] in sound["receivers"]]):
        chosen.sort(key=lambda one: sound["receivers"].index(one["name"]))
        text = "along [" + ", ".join(f"{component:.6g}" for component in sound["direction"]) + "]"
        return [[heard(one, text, sound["direction"])] for one in chosen]
    if blow.receivers:
        axes = list(zip("xyz", np.eye(3)))
        return [[heard(one, axis, direction) for axis, direction in axes] for one in blow.receivers[:2]]
    far = int(np.argmax(np.linalg.norm(kernel.node - kernel.node.mean(axis=0), axis=1)))
    direction = kernel.normal[far] if kernel.direction is None else kernel.direction
    return [[(f"point {far}", _core.Pickup(blow.body, "", far, direction.tolist()))]]


def loudest(
    channels: list[list[tuple[str, _core.Pickup]]], sound: Array, power: Array
) -> tuple[list[str], Array]:
    """Names and rows of the left and of the right channel: of each, the alternative that is loudest.

    sound: (p,N) of all alternatives, one channel after the other.
    power: (N) squared modal velocities after the blow."""
    names = [name for channel in channels for name, _ in channel]
    ends = np.cumsum([len(channel) for channel in channels])
    chosen = [start + int(np.argmax(sound[start:end] ** 2 @ power)) for start, end in zip([0, *ends], ends)]
    chosen = (chosen * 2)[:2]
    return [names[k] for k in chosen], sound[chosen]


class Tip:
    """The part of the mallet that strikes, and where else it can strike."""

    def __init__(self, striking: Striking, system: dict[str, Any]) -> None:
        self.striking, blow = striking, striking.blow
        nearest = int(np.argmin(system["gap"]))
        which = blow.names.index(blow.mallet)
        self.point = system["point_b" if blow.first else "point_a"][nearest]  # of the body
        own = system["point_a" if blow.first else "point_b"][nearest]
        self.out = system["normal"][nearest] * (1 if blow.first else -1)  # of the mallet
        self.turned = np.asarray(system["rotation"][which])
        self.at = self.turned.T @ (own - np.asarray(system["translation"][which]))  # its own axes

    def elsewhere(self, kernel: Kernel, most: int) -> list[Place]:
        """Places at the candidates of the body, in front of which the mallet fits."""
        asked = self.striking.blow.bodies[self.striking.blow.body]
        points = placed(self.striking.blow, kernel.node)
        normals = kernel.normal @ rotation_of(asked.get("rotate_deg", [0, 0, 0])).T
        out, bar = [], Progress(min(most, len(points)))
        for k in spread(points, most):
            bar.advance("places")
            with contextlib.suppress(InputError):  # the mallet does not fit, or its kernel ends there
                out.append(self.in_front(points[k], normals[k]))
        return out

    def keys_in_front(self, point: Array, normal: Array) -> dict[str, Any]:
        """Keys of the mallet that put it in front of a point of the body, and let it fly there at 1 m/s."""
        turned, striking = self.turned, self.striking
        if "direction" not in striking.blow.pair:
            turned = turn_between(self.out, -normal) @ turned
        size = np.linalg.norm(np.ptp(striking.kernels[striking.blow.mallet].node, axis=0))
        return {
            "rotate_deg": angles_of(turned),
            "translate": point + CLEARANCE * size * normal - turned @ self.at,
            "velocity": -normal,
        }

    def in_front(self, point: Array, normal: Array) -> Place:
        """The mallet in front of a point of the body. Raises InputError if it does not fit there."""
        system = self.striking.system(self.keys_in_front(point, normal), 0.0, [])
        return self.striking.place(system, point, normal, MOST_POINTS)


def placed(blow: Blow, points: Array) -> Array:
    """Points of the body, from its own axes into those of the world."""
    asked = blow.bodies[blow.body]
    turned = rotation_of(asked.get("rotate_deg", [0, 0, 0]))
    return np.asarray(points @ turned.T + np.array(asked.get("translate", [0, 0, 0]), float))


def spread(points: Array, most: int) -> Iterator[int]:
    """Indices of at most `most` points, each the farthest from those before it."""
    away = np.full(len(points), np.inf)
    chosen = 0
    for _ in range(min(most, len(points))):
        yield chosen
        away = np.minimum(away, np.linalg.norm(points - points[chosen], axis=1))
        chosen = int(np.argmax(away))
