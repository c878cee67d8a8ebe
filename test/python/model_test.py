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
