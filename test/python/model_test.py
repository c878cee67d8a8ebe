"""Arm files and the model: shapes, Jacobians against differences, bad inputs."""
import os
import unittest

import support

import numpy as np
import softarm

ARMS = {"online_200mm": 0.05, "two_segment": 0.02, "hybrid_85mm": 0.01, "cable_235mm": 0.02, "tendon_trunk": 0.02}  # payload, kg
SIZES = {"pressure": 2e4, "vacuum": 2e4, "tension": 1.0, "angle": 0.4}


class Arms(unittest.TestCase):
    def test_every_shipped_arm_loads_and_says_what_it_is(self):
        self.assertIn("online_200mm", softarm.shipped_arms())
        for name in softarm.shipped_arms():
            arm = softarm.load_arm(name)
            self.assertEqual(sum(one.length_m for one in arm.segments), arm.length_m)
            self.assertTrue(arm.bodies and arm.inputs and arm.constants)
            self.assertEqual(arm.to_dict()["name"], arm.name)
            self.assertEqual(softarm.parse_arm(arm.text).constants, arm.constants)

    def test_constants_change_the_file_and_nothing_else(self):
        arm = softarm.load_arm("online_200mm")
        name = next(one for one in arm.constants if one.endswith("bending_stiffness.base"))
        changed = arm.with_constants({name: 0.0471})
        self.assertAlmostEqual(changed.constants[name].value, 0.0471, delta=1e-10)
        self.assertEqual({key: value for key, value in changed.constants.items() if key != name},
                         {key: value for key, value in arm.constants.items() if key != name})
        before, after = arm.text.splitlines(), changed.text.splitlines()
        self.assertEqual(len(before), len(after))
        self.assertEqual(sum(one != other for one, other in zip(before, after)), 1)
        target = support.path("changed.yaml")
        changed.save(target)
        self.assertEqual(softarm.load_arm(target).constants, changed.constants)
        with self.assertRaises(FileExistsError):
            changed.save(target)
        changed.save(target, force=True)
        self.assertFalse([one for one in os.listdir(support.FOLDER) if one.endswith(".partial")])

    def test_effects_have_their_errors(self):
        plain = softarm.load_arm("online_200mm")
        self.assertEqual(plain.effects, [])
        self.assertEqual(plain.effects_correlations.names, [])
        self.assertEqual(plain.effects_correlations.sd.shape, (0,))
        self.assertEqual(plain.effects_correlations.matrix.shape, (0, 0))
        arm = softarm.parse_arm(plain.text + """
effects:
  - {id: creep, parameters: {share: 0.1, time_s: 3, decades: 1}, sd: {share: 0.01, time_s: 1, decades: 0}}
  - {id: marker_slip, parameters: {x_m: 0.001, body: 1}, sd: {x_m: 0.002}}
  - {id: marker_slip, parameters: {x_m: 0.001, body: 2}, sd: {x_m: 0.003}}
effects_correlations:
  - {of: creep.share, with: {creep.time_s: 0.6, marker_slip.2.x_m: -0.3}}
  - {of: marker_slip.1.x_m, with: {marker_slip.2.x_m: 0.8}}
""", "mine.yaml")
        self.assertEqual(arm.effects[0], {"id": "creep", "numbers": {"share": 0.1, "time_s": 3.0, "decades": 1.0},
                                          "sd": {"share": 0.01, "time_s": 1.0, "decades": 0.0}})
        self.assertEqual([one["sd"] for one in arm.effects[1:]], [{"x_m": 0.002}, {"x_m": 0.003}])
        names, sd, matrix = arm.effects_correlations
        # One whose sd is 0 is known, and has no error that could go with others.
        self.assertEqual(names, ["creep.share", "creep.time_s", "marker_slip.1.x_m", "marker_slip.2.x_m"])
        np.testing.assert_array_equal(sd, [0.01, 1.0, 0.002, 0.003])
        np.testing.assert_array_equal(matrix, [[1.0, 0.6, 0.0, -0.3], [0.6, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.8],
                                               [-0.3, 0.0, 0.8, 1.0]])
        self.assertEqual(matrix.dtype, np.float64)

    def test_what_is_wrong_is_one_line(self):
        arm = softarm.load_arm("online_200mm")
        support.one_line(self, softarm.ArmError, lambda: softarm.load_arm("nowhere"), "nowhere", "online_200mm")
        wrong = arm.text.replace("segments:", "segmens:", 1)
        support.one_line(self, softarm.ArmError, lambda: softarm.parse_arm(wrong, "mine.yaml"), "mine.yaml", "segmens")
        support.one_line(self, softarm.ArmError, lambda: softarm.parse_arm("a: [1", "mine.yaml"), "mine.yaml")
        name = next(iter(arm.constants))
        support.one_line(self, ValueError, lambda: arm.with_constants({name + "x": 1.0}), name, "did you mean")
        support.one_line(self, ValueError, lambda: arm.with_constants({name: float("nan")}), name, "nan")
        support.one_line(self, ValueError, lambda: arm.with_constants({name: 1e30}), name, "from")
        with self.assertRaises(softarm.Error):  # all of them are
            softarm.load_arm("nowhere")


class Models(unittest.TestCase):
    def load(self, name):
        arm = softarm.load_arm(name)
        return arm, {one.name: (0.4 + 0.17 * k) * SIZES[one.kind] for k, one in enumerate(arm.inputs)}, ARMS[name]

    def test_jacobians_are_differences_of_shapes(self):
        for name in ARMS:
            arm, inputs, payload = self.load(name)
            constants = [one.name for one in arm.constants.values() if one.stated and one.value and "length" not in one.name
                         and ".wall." not in one.name and not one.name.endswith("elongation")]
            model = softarm.Model(arm, points=5, constants=constants)
            shapes = model.solve(inputs, payload, jacobians=True)
            self.assertEqual(list(shapes.status), ["ok"], name)
            jacobians = shapes.jacobians

            def expect(derivative, above, below, step, what):
                expected = (above - below) / (2.0 * step)
                self.assertLess(np.abs(derivative - expected).max(), 1e-4 * np.abs(expected).max() + 2e-10 / step,
                                f"{name}: {what}")

            for k, one in enumerate(arm.inputs):
                step = 1e-3 * inputs[one.name]
                above, below = (model.solve({**inputs, one.name: inputs[one.name] + by}, payload) for by in (step, -step))
                expect(jacobians.bodies_by_inputs[0, ..., k], above.bodies_p_base_m[0], below.bodies_p_base_m[0], step, one.name)
                expect(jacobians.points_by_inputs[0, ..., k], above.p_base_m[0], below.p_base_m[0], step, one.name)
            above, below = model.solve(inputs, payload + 1e-4), model.solve(inputs, payload - 1e-4)
            expect(jacobians.bodies_by_payload[0], above.bodies_p_base_m[0], below.bodies_p_base_m[0], 1e-4, "payload")
            gravity = np.array(arm._handle.gravity_base_m_s2)
            for axis in range(3):
                change = 1e-3 * np.eye(3)[axis]
                above, below = (model.solve(inputs, payload, gravity_base_m_s2=gravity + by) for by in (change, -change))
                expect(jacobians.bodies_by_gravity[0, ..., axis], above.bodies_p_base_m[0], below.bodies_p_base_m[0], 1e-3, "gravity")
            for k, constant in enumerate(constants):
                value = arm.constants[constant].value
                step = 1e-3 * abs(value)
                above, below = (softarm.Model(arm.with_constants({constant: value + by}), points=5).solve(inputs, payload)
                                for by in (step, -step))
                expect(jacobians.bodies_by_constants[0, ..., k], above.bodies_p_base_m[0], below.bodies_p_base_m[0], step, constant)

    def test_shapes_are_physical(self):
        arm = softarm.load_arm("online_200mm")
        model = softarm.Model(arm)
        none = model.solve(gravity_base_m_s2=[0.0, 0.0, -9.8])
        np.testing.assert_allclose(none.p_base_m[0, :, :2], 0.0, atol=1e-9)  # straight along its own weight
        self.assertEqual(none.p_base_m.shape, (1, 41, 3))
        loads = np.linspace(0.0, 0.05, 6)
        sag = model.solve(payload_kg=loads, gravity_base_m_s2=[0.0, -9.8, 0.0])
        self.assertTrue((np.diff(sag.p_base_m[:, -1, 1]) < 0.0).all())
        # At the base: the weight of all, at the tip the payload's.
        mass = sum(one.mass_kg for one in arm.segments) + arm.to_dict().get("tip_mass", 0.0)
        np.testing.assert_allclose(np.linalg.norm(sag.force_base_n[:, 0], axis=1), 9.8 * (mass + loads), rtol=2e-2)
        self.assertEqual(set(sag.status), {"ok"})

    def extended(self, *effects):
        """The arm online_200mm with effects in its file, and a model of it; it says that they are in it."""
        text = "\neffects:\n" + "".join(f"  - {{id: {name}, parameters: {{{numbers}}}}}\n" for name, numbers in effects)
        arm = softarm.parse_arm(softarm.load_arm("online_200mm").text + text, "mine.yaml")
        with self.assertWarnsRegex(softarm.SoftarmWarning, "in the model: .*" + effects[0][0]):
            return arm, softarm.Model(arm)

    def test_effects_are_those_of_an_estimate(self):
        """Bodies where the model with effects has them: an estimate with them finds the laws, one without does not."""
        arm, model = self.extended(("base_compliance", "compliance_rad_per_nm: 0.3"), ("payload_scale", "share: 0.2"))
        self.assertEqual(len(model.notes), 1)
        n = 20
        inputs = {"chamber_1": np.linspace(2e4, 4e4, n), "chamber_2": np.linspace(1e4, 3e4, n)}
        # The base horizontal: turned about x, so that the arm file's gravity, along the mocap's -z, is along its -y.
        half = np.sqrt(0.5)
        q = np.tile([half, 0.0, 0.0, half], (n, 1))
        shapes = model.solve(inputs, 0.1, gravity_base_m_s2=[0.0, -9.80665, 0.0])
        self.assertEqual(set(shapes.status), {"ok"})
        p = np.stack([shapes.bodies_p_base_m[..., 0], -shapes.bodies_p_base_m[..., 2], shapes.bodies_p_base_m[..., 1]], axis=-1)
        trial = softarm.Trial.from_arrays(arm, 0.6 * np.arange(n), p, base_p_mocap_m=np.zeros((n, 3)), base_q_mocap_xyzw=q,
                                          inputs=inputs, payload_kg=0.1)
        with self.assertWarns(softarm.SoftarmWarning):
            found = softarm.estimate(trial)
        self.assertEqual(set(found.status), {"ok"})
        np.testing.assert_allclose(found.EI_nm2, shapes.EI_nm2, rtol=2e-3)
        np.testing.assert_allclose(found.M0_nm, shapes.M0_nm, rtol=2e-3)
        self.assertLess(np.abs(found.bodies_estimated_base_m - shapes.bodies_p_base_m).max(), 2e-5)
        plain = softarm.load_arm("online_200mm")
        self.assertGreater(np.abs(softarm.estimate(trial, arm=plain).EI_nm2 / shapes.EI_nm2 - 1.0).max(), 0.05)

    def test_jacobians_with_effects_are_differences_of_shapes(self):
        arm, model = self.extended(("base_compliance", "compliance_rad_per_nm: 0.2"))
        name = "segment_1.bending_stiffness.base"
        value = arm.constants[name].value

        def tip(of, pressure_pa):
            return of.solve({"chamber_1": pressure_pa}, 0.1, gravity_base_m_s2=[0.0, -9.0, 3.0], jacobians=True)

        with self.assertWarns(softarm.SoftarmWarning):
            of_constant = softarm.Model(arm, constants=[name])
            stiffer, softer = (softarm.Model(arm.with_constants({name: (1.0 + by) * value})) for by in (2e-3, -2e-3))
        at = tip(of_constant, 3e4)
        by_input = (tip(model, 3e4 + 100.0).p_base_m - tip(model, 3e4 - 100.0).p_base_m) / 200.0
        np.testing.assert_allclose(at.jacobians.points_by_inputs[..., 0], by_input, atol=2e-3 * np.abs(by_input).max())
        by_constant = (tip(stiffer, 3e4).bodies_p_base_m - tip(softer, 3e4).bodies_p_base_m) / (4e-3 * value)
        np.testing.assert_allclose(at.jacobians.bodies_by_constants[..., 0], by_constant, atol=2e-3 * np.abs(by_constant).max())

    def test_effects_remember_within_a_trial(self):
        _, model = self.extended(("hysteresis", "share: 0.3, width_pa: 2000, of: 0"))
        inputs = {"chamber_1": np.concatenate([np.linspace(0.0, 4e4, 30), np.linspace(4e4, 0.0, 30)])}
        stamps = 0.1 * np.arange(60)
        remembered = model.solve(inputs, stamp_s=stamps).p_base_m[:, -1]
        alone = model.solve(inputs).p_base_m[:, -1]
        self.assertGreater(np.abs(remembered[15] - remembered[44]).max(), 3e-4)  # of equal pressure, up and down
        np.testing.assert_allclose(alone[15], alone[44], atol=1e-7)
        np.testing.assert_array_equal(model.solve(inputs, stamp_s=stamps).p_base_m[:, -1], remembered)
        for wrong, words in ((dict(stamp_s=stamps[::-1]), ["stamp_s", "increase"]), (dict(stamp_s=stamps[:3]), ["different lengths"]),
                             (dict(stamp_s=stamps, jacobians=True), ["jacobians", "stamp_s"]), (dict(stamp_s="now"), ["stamp_s", "str"])):
            support.one_line(self, ValueError, lambda: model.solve(inputs, **wrong), *words)

    def test_inputs_by_name_and_as_arrays(self):
        arm, inputs, payload = self.load("online_200mm")
        model = softarm.Model(arm)
        names = [one.name for one in arm.inputs]
        first = names[0]
        by_name = model.solve({first: [0.0, 1e4, 2e4]}, payload)
        array = np.zeros((3, len(names)))
        array[:, 0] = [0.0, 1e4, 2e4]
        np.testing.assert_array_equal(by_name.p_base_m, model.solve(array, payload).p_base_m)
        self.assertEqual(len(by_name.to_dict()["status"]), 3)
        frame = model.solve({first: [0.0, 1e4, 2e4]}, payload, jacobians=True).to_pandas()
        np.testing.assert_array_equal(frame[f"{arm.bodies[1].name}_z_m"], by_name.bodies_p_base_m[:, 1, 2])
        np.testing.assert_array_equal(frame[f"{arm.segments[0].name}_EI_nm2"], by_name.EI_nm2[:, 0])
        jacobians = model.solve(inputs, payload, jacobians=True).jacobians.to_dict()
        self.assertEqual(np.shape(jacobians["bodies_by_inputs"]), (1, len(arm.bodies), 3, len(names)))

    def test_what_is_wrong_is_one_line(self):
        arm, inputs, payload = self.load("online_200mm")
        model = softarm.Model(arm)
        first = arm.inputs[0].name
        for wrong, words in (
                (lambda: model.solve({"chamber_9": 1.0}), ["chamber_9", first]),
                (lambda: model.solve({first: float("nan")}), [first, "nan", "finite"]),
                (lambda: model.solve({first: [1.0, 2.0]}, [0.0, 0.1, 0.2]), ["different lengths"]),
                (lambda: model.solve(np.zeros((2, 9))), ["(2, 9)", first]),
                (lambda: model.solve(np.zeros((2, len(arm.inputs))), [0.0, 0.1, 0.2]), ["(3,)", "(2"]),
                (lambda: model.solve(inputs, -1.0), ["payload_kg", "-1"]),
                (lambda: model.solve(inputs, "heavy"), ["payload_kg", "str"]),
                (lambda: model.solve(inputs, gravity_base_m_s2=[0.0, 1.0]), ["gravity_base_m_s2"]),
                (lambda: softarm.Model(arm, points=1), ["points", "1001"]),
                (lambda: softarm.Model(arm, constants=["stiffness"]), ["stiffness"])):
            support.one_line(self, ValueError, wrong, *words)


if __name__ == "__main__":
    support.main()
