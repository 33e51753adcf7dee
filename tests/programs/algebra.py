# SPDX-License-Identifier: BSD-2-Clause
"""Kernels that ricochet-kernel or ricochet-recast derive from others in the folder equal computed ones."""

import pathlib
import shutil
import unittest

import h5py
import numpy as np

import scenes
from programs import BIN, ProgramTest, Run, contact, kernel, static_responses

SCENE = scenes.block_on_floor(
    "Algebra",
    "up_to_hz = 1.5",
    "spacing = 0.4\ngap = 0.1",
    "rate_hz = 100\nduration = 1.0",
    more="[loads]\ngravity = [0, 0, -1]\n[output]\nview = true",
)

# Twice the size with another stiffness and density: frequencies are
# √(1.7 / 0.6) / 2 = 0.842 times the old ones.
OTHER = [
    "bodies.block.scale=2",
    "bodies.block.material.young=5.1",
    "bodies.block.material.density=1.2",
    "bodies.block.damping={rayleigh=[0.1,0.01]}",
    "contact.spacing=0.8",
]
FACTORS = ["--young-factor", 1.7, "--density-factor", 0.6, "--scale-factor", 2]
FASTER = np.sqrt(1.7 / 0.6) / 2


def functions(file):
    """Σ_n v_n v_nᵀ sin(ω_n t)/ω_n at some times, over all modal data of a kernel. These sums do not depend on the choice of
    vectors within a multiple mode. Each quantity is scaled by its largest value."""
    omega, decay = file["modes/angular_frequency"][:], file["modes/decay_rate"][:]
    sets = [
        file[name][:].reshape(-1, omega.size)
        for name in ("surface/shape", "loads/body_force", "loads/rotation")
    ]
    rows = np.vstack([values / (np.abs(values).max() or 1) for values in sets])
    times = np.linspace(0.1, 20, 40)[:, None]
    sine = np.where(omega > 0, np.sin(omega * times) / np.where(omega > 0, omega, 1), times) * np.exp(
        -decay * times
    )
    return np.einsum("in,tn,jn->tij", rows, sine, rows)


def flexibility(file):
    """Largest static displacement of a candidate under a unit force on it, from the elastic modes."""
    omega = file["modes/angular_frequency"][:]
    shape = file["surface/shape"][:].reshape(-1, omega.size)[:, omega > 0]
    return (shape**2 / omega[omega > 0] ** 2).sum(axis=1).max()


def static_flexibility(file):
    """Static displacements of the candidates under unit forces on them, from the elastic modes and R."""
    omega = file["modes/angular_frequency"][:]
    shape = file["surface/shape"][:].reshape(-1, omega.size)[:, omega > 0] / omega[omega > 0]
    return shape @ shape.T + file["surface/residual_flexibility"][:]


class Algebra(ProgramTest):
    @classmethod
    def setUpClass(cls):
        cls.made = cls.shared_folder()
        (cls.made / "block.geo").write_text(scenes.skewed_block(0.4))
        (cls.made / "algebra.toml").write_text(SCENE)
        run = kernel(cls.made / "algebra.toml", cls.made)
        assert run.status == 0, run.err

    def setUp(self):
        super().setUp()
        self.scene = shutil.copy(self.made / "algebra.toml", self.folder)
        shutil.copy(self.made / "block.geo", self.folder)
        self.out, self.fresh = self.folder / "out", self.folder / "fresh"

    def default(self):
        """The kernel of the scene as it is, in `out`."""
        self.out.mkdir()
        return pathlib.Path(shutil.copy(self.one(self.made), self.out))

    def assert_close(self, one, other, bound, name, scale=0):
        """Checks equality within `bound` times the largest value, or times `scale` if that is larger."""
        one, other = np.asarray(one, dtype=float), np.asarray(other, dtype=float)
        self.assertEqual(one.shape, other.shape, name)
        largest = max(np.abs(other).max(initial=0), scale)
        self.assertLessEqual(np.abs(one - other).max(initial=0), bound * largest, name)

    def assert_same(self, path, computed):
        """Checks that both kernel files are equivalent. Modes are accurate to 1e-8 according to their residuals."""
        bound = 1e-8
        self.assertEqual(path.name, computed.name)
        with h5py.File(path) as a, h5py.File(computed) as b:
            for name in set(b.attrs) - {"mass"}:
                self.assertEqual(a.attrs[name], b.attrs[name], name)
            self.assert_close(a.attrs["mass"], b.attrs["mass"], 1e-12, "mass")
            found, expected = a["modes/certificate"].attrs, b["modes/certificate"].attrs
            self.assertEqual(set(found), set(expected))
            for name in ("below", "count_by_inertia", "count_found", "left_out", "complete"):
                self.assertEqual(found[name], expected[name], name)
            if b"count = " in b.attrs["scene"]:  # the end may be anywhere up to the next mode
                self.assertGreater(2 * np.pi * found["upto_hz"], a["modes/angular_frequency"][-1])
            else:
                self.assert_close(found["upto_hz"], expected["upto_hz"], 1e-8, "upto_hz")
            names = {"": [], "/": []}
            for file, key in ((a, ""), (b, "/")):
                file.visit(names[key].append)
            # A truncated kernel may have no inertia count below its end.
            counts = {"modes/certificate/shift", "modes/certificate/modes_below"}
            self.assertEqual(set(names[""]) - counts, set(names["/"]) - counts)
            for name in (
                "body/centre",
                "body/inertia",
                "surface/node",
                "surface/normal",
                "surface/area",
                "view/node",
            ):
                if name in b:
                    self.assert_close(a[name], b[name], 1e-12, name)
            for name in ("modes/angular_frequency", "modes/decay_rate"):
                self.assert_close(a[name], b[name], bound, name)
            # The truncated part may be only round-off of the whole: the sag
            # of a free body, R of Ritz vectors.
            yielding = flexibility(b)
            name = "surface/residual_flexibility"
            self.assert_close(a[name], b[name], bound, name, yielding)
            name = "loads/body_force_residual"
            self.assert_close(a[name], b[name], bound, name, yielding * b.attrs["mass"])
            for name in ("surface/element", "surface/group"):
                np.testing.assert_array_equal(a[name], b[name])
            self.assert_close(functions(a), functions(b), bound, "kernel functions")
            if "view" in b:
                self.assert_close(
                    np.abs(a["view/shape"]), np.abs(b["view/shape"]), 1e-5, "view"
                )  # single precision

    def path(self, folder, *sets, ranks=1):
        """Computes or derives the kernel that the scene needs with these settings. Returns its path and the run."""
        before = set(folder.glob("*.kernel.h5"))
        run = self.succeed(kernel(self.scene, folder, *sets, ranks=ranks, quiet=False))
        new = set(folder.glob("*.kernel.h5")) - before
        self.assertEqual(len(new), 1)
        return new.pop(), run

    def check(self, before, after, ranks=1):
        """Checks that the second request is derived from the kernel of the first and equals a computed kernel."""
        old, _ = self.path(self.out, *before)
        derived, run = self.path(self.out, *after, ranks=ranks)
        self.assertIn(f"derived from {old.name}", run.out)
        self.assertNotIn("assembly", run.out + run.err)
        computed, run = self.path(self.fresh, *after)
        self.assertIn("assembly", run.err)
        self.assert_same(derived, computed)

    def test_another_material_and_size_cut_to_a_band(self):
        self.check([], [*OTHER, "modes.up_to_hz=0.9", "output.view=false"], ranks=2)

    def test_one_direction_of_a_turned_body_out_of_all(self):
        every = "modes.residual_components=all"
        self.check(
            [every],
            [
                every,
                *OTHER,
                "bodies.block.rotate_deg=[0,0,30]",
                "contact.direction=[0,0.6,-0.8]",
                "modes.up_to_hz=1",
            ],
        )

    def test_vectors_fitted_to_contact_in_the_same_band(self):
        modes = 'modes={{basis="contact",up_to_hz={}}}'
        self.check([modes.format(0.5)], [*OTHER, modes.format(0.5 * FASTER)])

    def test_vectors_above_the_band_are_in_the_residual_flexibility(self):
        bases = ['modes={up_to_hz=0.5,residual_components="all"}'] + [
            f'modes={{basis="contact",up_to_hz=0.5,residual_components="all",residual_flexibility={kept}}}'
            for kept in ("true", "false")
        ]
        files = [h5py.File(self.path(self.out, words)[0]) for words in bases]
        highest = [file["modes/angular_frequency"][-1] / (2 * np.pi) for file in files]
        self.assertLessEqual(highest[1], 0.5)
        self.assertGreater(highest[2], 1)
        certificate = files[1]["modes/certificate"].attrs
        self.assertGreater(certificate["left_out"], 0)
        self.assertEqual(
            certificate["count_found"] - certificate["left_out"], len(files[1]["modes/residual"])
        )
        # Without rigid motion, both have the static flexibility of the body.
        exact, found = (static_flexibility(file) for file in files[:2])
        np.testing.assert_allclose(found, exact, rtol=0, atol=1e-9 * np.abs(exact).max())

    def test_receivers_loads_and_moving_supports_at_places_that_scale(self):
        def sources(scale):
            at = [scale * x for x in (0.1, 0.2, 0.3)]
            return [
                "bodies.block.support={side='xyz'}",
                f"output.receiver=[{{name='mic',body='block',at={at}}}]",
                f"output.gauge=[{{name='foil',body='block',at={at},direction=[0,0.6,0.8],length={scale * 0.1}}}]",
                "loads.traction=[{body='block',group='foot',vector=[0,0,1]}]",
                f"loads.point=[{{body='block',at={at[::-1]},vector=[0,0,1]}}]",
                "loads.motion=[{body='block',group='side',vector=[0,1,0]}]",
            ]

        damping = "bodies.block.damping={t60=[[0.2,9],[1.2,0.5]]}"
        self.check(sources(1), [*sources(2), *OTHER, damping, "modes.up_to_hz=1"], ranks=2)
        # Sums of modes and static parts, which do not depend on the end of the band.
        (derived,) = set(self.fresh.glob("*.kernel.h5"))
        found, expected = (static_responses(path) for path in (self.out / derived.name, derived))
        self.assertEqual(set(found), set(expected))
        for name, values in expected.items():
            # A support that moves the whole body strains it by round-off alone.
            self.assert_close(found[name], values, 1e-7, name, 1 if "moved" in name[1] else 0)
        old, _ = self.path(self.fresh, *sources(1))
        again = self.folder / "recast"
        self.succeed(self.recast(old, *FACTORS, "--up-to-hz", 0.9, "--out", again))
        sets = [*sources(2), *OTHER[:3], OTHER[4], "modes.up_to_hz=0.9"]
        run = self.succeed(kernel(self.scene, again, *sets, quiet=False))
        self.assertIn("block: already there", run.out)

    def test_what_does_not_follow_is_computed(self):
        self.default()
        for sets in (
            ["modes.up_to_hz=2"],
            ["bodies.block.material.poisson=0.2"],
            ["contact.spacing=0.5"],
            ["bodies.block.material.young=1"],
        ):
            with self.subTest(sets=sets):
                _, run = self.path(self.out, *sets)
                self.assertNotIn("derived", run.out)
                self.assertIn("assembly", run.err)

    def recast(self, *words):
        return Run([BIN / "ricochet-recast", *words])

    def test_recast_kernels_serve_the_scenes_that_ask_for_them(self):
        old = self.default()
        other = self.folder / "recast"
        self.succeed(self.recast(old, *FACTORS, "--up-to-hz", 0.9, "--out", other))
        (path,) = other.glob("*.kernel.h5")
        sets = [*OTHER[:3], OTHER[4], "modes.up_to_hz=0.9"]
        self.assert_same(path, self.path(self.fresh, *sets)[0])
        self.succeed(contact(self.scene, other, *sets))

    def test_recast_to_a_flexibility_error_says_what_it_left_out(self):
        old = self.default()
        run = self.succeed(self.recast(old, "--up-to-hz", 0.2, "--flexibility-error", 0.1))
        with h5py.File(old) as file:
            all_modes = file["modes/angular_frequency"].size
        self.succeed(contact(self.scene, self.out, "modes.up_to_hz=0.2", "modes.flexibility_error=0.1"))
        (path,) = set(self.out.glob("*.kernel.h5")) - {old}
        with h5py.File(path) as file:
            kept, certificate = file["modes/angular_frequency"].size, file["modes/certificate"].attrs
            self.assertLess(kept, all_modes)
            self.assertEqual(certificate["left_out"], all_modes - kept)
            self.assertLessEqual(certificate["flexibility_error"], 0.1)
        self.assertIn(f"{kept} of {all_modes} modes", run.out)
        self.assertIn(str(path), run.out)

    def test_recast_to_points_and_again_to_fewer(self):
        old = self.default()
        first, second, at_once = (self.folder / name for name in ("first", "second", "at-once"))
        self.succeed(self.recast(old, "--points", "3,2,1", "--out", first))
        (three,) = first.glob("*.kernel.h5")
        self.succeed(self.recast("--points", "2,0", three, "--out", second))
        self.succeed(self.recast(old, "--points", "1,3", "--out", at_once))
        (two,), (same,) = second.glob("*.kernel.h5"), at_once.glob("*.kernel.h5")
        self.assertEqual(two.name, same.name)
        self.assertEqual(two.read_bytes(), same.read_bytes())
        with h5py.File(old) as a, h5py.File(two) as b:
            np.testing.assert_array_equal(b["surface/node"], a["surface/node"][:][[1, 3]])
            np.testing.assert_array_equal(b["surface/shape"], a["surface/shape"][:][[1, 3]])

    def test_kernels_with_receivers_are_drawn_but_keep_their_candidates(self):
        old, _ = self.path(self.out, 'output.receiver=[{name="mic",body="block",at=[0,0,0]}]')
        reason = "has loads, moving supports, receivers or gauges: compute the requested kernel"
        self.refused(self.recast(old, "--points", "1,3"), reason)
        self.succeed(self.recast(old, "--vtk"))
        self.assertTrue(old.with_name(old.name.replace(".kernel.h5", ".modes.xdmf")).is_file())

    def test_recast_refuses_a_body_that_no_scene_may_hold(self):
        old = self.default()
        stiff = self.folder / "stiff"
        self.succeed(self.recast(old, "--young-factor", 1e18, "--out", stiff))
        run = self.recast(*stiff.glob("*.kernel.h5"), "--young-factor", 1e18)
        self.assertEqual((run.status, len(list(stiff.iterdir()))), (2, 1))
        self.assertIn("body.material.young = 3e+36", run.err)

    def test_recast_refuses_in_one_line(self):
        old = self.default()
        before = set(self.folder.rglob("*"))
        for words, fragments in (
            ([old, "--up-to-hz", 3], [str(old), "all modes up to 1.5 Hz, not up to 3"]),
            ([old, "--young-factor", 0.5, "--up-to-hz", 1.4], ["up to 1.06066 Hz"]),
            ([old, "--points", "0,400"], [str(old), "no candidate 400"]),
            ([old, "--flexibility-error", 1e-4], [str(old), "may cause an error of"]),
            ([old, "--count", 3, "--up-to-hz", 1], ["--count", "--up-to-hz"]),
            ([old, "--density-factor", 0], ["--density-factor"]),
            ([old, "--young-factor", 1e300], ["--young-factor"]),
            ([old, "--young-factor", "nan"], ["--young-factor", "above 0"]),
            ([old, "--points", ""], ["--points"]),
            ([self.scene], [str(self.scene), "is not a kernel"]),
            ([self.folder / "none.h5"], ["none.h5"]),
        ):
            with self.subTest(words=words):
                self.refused(self.recast(*words), *fragments)
        self.assertEqual(before, set(self.folder.rglob("*")))


if __name__ == "__main__":
    unittest.main()
