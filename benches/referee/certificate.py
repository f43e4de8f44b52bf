"""The least friction with which a specimen can stand.

    certificate.py answer    specimens on standard input, one a line, as
                             `referee contacts` writes them; answers likewise
    certificate.py check     its own checks

A specimen at rest is possible only if forces in the friction cones of its
contact points carry every grain's weight. For a friction coefficient that is a
convex problem: the forces in the cones that leave the least of the weights
uncarried (clarabel). Whatever an engine did on the way, a specimen that needs
more friction than it has is wrong.
"""

import json
import sys

import clarabel
import numpy as np
from scipy import sparse

# What may be left uncarried, over all weights, in the Euclidean norm.
UNCARRIED = 1e-4
# The same of one grain that stands by itself or falls, over its weight.
FALLS = 1e-2
# Share of the grains that may be left with more than that, where the rest is asked of.
ODD_ONES = 0.01
# Friction beyond which nothing stands that did not before.
MOST_FRICTION = 10.0
# Precision of the answer.
PRECISION = 0.005


class Specimen:
    def __init__(self, given):
        self.weights = np.array(given["weights_n"], float).reshape(-1, 3)
        self.centres = np.array(given["centres_m"], float).reshape(-1, 3)
        self.contacts = given["contacts"]
        self.length = float(np.mean(given["radii_m"]))
        self.force = float(np.mean(np.linalg.norm(self.weights, axis=1)))
        self.stands = np.ones(len(self.weights), bool)
        self.known = {}

    def loaded(self):
        """Contacts of grains that stand."""
        return [
            c
            for c in self.contacts
            if self.stands[c["a"]] and (c["b"] < 0 or self.stands[c["b"]])
        ]

    def balance(self, contacts):
        """What forces (normal, two tangents) of contacts do to grains."""
        rows, columns, values = [], [], []
        for k, c in enumerate(contacts):
            normal = np.array(c["normal"], float)
            away = np.eye(3)[np.argmin(np.abs(normal))]
            first = np.cross(normal, away)
            first /= np.linalg.norm(first)
            axes = np.stack([normal, first, np.cross(normal, first)], axis=1)
            point = np.array(c["point_m"], float)
            for body, sign in ((c["a"], 1.0), (c["b"], -1.0)):
                if body < 0:
                    continue
                arm = (point - self.centres[body]) / self.length
                block = sign * np.concatenate([axes, np.cross(arm, axes, axis=0)])
                r, m = np.meshgrid(np.arange(6), np.arange(3), indexing="ij")
                rows.append((6 * body + r).ravel())
                columns.append((3 * k + m).ravel())
                values.append(block.ravel())
        size = (6 * len(self.weights), 3 * len(contacts))
        if not rows:
            return sparse.csc_matrix(size)
        joined = [np.concatenate(x) for x in (rows, columns, values)]
        return sparse.csc_matrix((joined[2], (joined[0], joined[1])), shape=size)

    def uncarried(self, factor, most=None):
        """Least force and moment that is left, of each grain over the mean
        weight, with friction coefficients `factor` times as large, or `most`."""
        contacts = self.loaded()
        forces, rest = 3 * len(contacts), 6 * len(self.weights)
        weights = np.zeros((len(self.weights), 6))
        weights[self.stands, :3] = self.weights[self.stands] / self.force
        matrix = self.balance(contacts)
        # balance · f − r = −weights; friction · f_n ≥ |f_t| in cones of three.
        equal = sparse.hstack([matrix, -sparse.identity(rest)])
        friction = [most if most is not None else factor * c["friction"] for c in contacts]
        scale = np.ones(forces)
        scale[0::3] = friction
        cones = sparse.hstack([-sparse.diags(scale), sparse.csc_matrix((forces, rest))])
        a = sparse.vstack([equal, cones], format="csc")
        b = np.concatenate([-weights.ravel(), np.zeros(forces)])
        kinds = [clarabel.ZeroConeT(rest)] + [clarabel.SecondOrderConeT(3)] * len(contacts)
        # A trace of the forces themselves keeps idle ones from growing.
        p = sparse.diags(np.concatenate([np.full(forces, 1e-10), np.ones(rest)]), format="csc")
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        settings.max_threads = 1
        solution = clarabel.DefaultSolver(p, np.zeros(forces + rest), a, b, kinds, settings).solve()
        left = np.array(solution.x)[forces:].reshape(-1, 6)
        return np.linalg.norm(left, axis=1)

    def weights_alone(self):
        """Each grain's weight over the mean."""
        return np.linalg.norm(self.weights, axis=1) / self.force

    def left(self, factor):
        """What is left uncarried of each grain that does not fall, over the mean
        weight."""
        if factor not in self.known:
            self.known[factor] = self.uncarried(factor)[self.stands]
        return self.known[factor]

    def all_carried(self, factor):
        weights = self.weights_alone()[self.stands]
        return np.linalg.norm(self.left(factor)) <= UNCARRIED * np.linalg.norm(weights)

    def unbalanced(self, factor):
        """How many grains are left with more than a little of their weight."""
        return int((self.left(factor) > FALLS * self.weights_alone()[self.stands]).sum())

    def most_carried(self, factor):
        return self.unbalanced(factor) <= ODD_ONES * len(self.weights)

    def take_out_what_falls(self):
        """Takes out grains that no friction holds, until all others stand."""
        own = self.weights_alone()
        for _ in range(20):
            left = self.uncarried(1.0, MOST_FRICTION)
            falls = self.stands & (left > FALLS * own)
            if not falls.any():
                break
            self.stands &= ~falls
        self.known = {}

    def least_factor(self, carried):
        """Least multiple of the friction coefficients with which the weights are
        carried, by one of the two measures above."""
        largest = max((c["friction"] for c in self.loaded()), default=0.0)
        if largest == 0 or not carried(MOST_FRICTION / largest):
            return None
        # Without any friction a cone is no cone for the solver.
        low, high = PRECISION / largest, MOST_FRICTION / largest
        if carried(low):
            return low
        # The specimen's own friction is asked first: most stand with it.
        guess = 1.0
        while (high - low) * largest > PRECISION:
            if carried(guess):
                high = guess
            else:
                low = guess
            guess = 0.5 * (low + high)
        return high


def answer(given):
    specimen = Specimen(given)
    specimen.take_out_what_falls()
    factor = specimen.least_factor(specimen.all_carried)
    of_most = specimen.least_factor(specimen.most_carried)
    friction = max((c["friction"] for c in specimen.contacts), default=0.0)
    own = specimen.weights_alone()
    left = specimen.left(1.0)
    return {
        "grains": len(specimen.weights),
        "contacts": len(specimen.contacts),
        "fall": int((~specimen.stands).sum()),
        "friction": friction,
        "least_factor": factor,
        "least_friction": None if factor is None else factor * friction,
        "least_friction_of_most": None if of_most is None else of_most * friction,
        # With the friction that it has, of the grains that do not fall.
        "unbalanced": specimen.unbalanced(1.0),
        "worst_left": float((left / own[specimen.stands]).max(initial=0.0)),
        "left": float(np.linalg.norm(left) / np.linalg.norm(own)),
    }


def block(angle, friction, corners=4):
    """A block on a slope, carried at the given number of its corners."""
    weight = [np.sin(angle), 0.0, -np.cos(angle)]
    points = [[x, y, -0.5] for x in (-0.5, 0.5) for y in (-0.5, 0.5)][:corners]
    contacts = [
        {"a": 0, "b": -1, "point_m": p, "normal": [0, 0, 1], "friction": friction} for p in points
    ]
    return {"weights_n": [weight], "centres_m": [[0, 0, 0]], "radii_m": [1], "contacts": contacts}


def wedge(half_angle, friction):
    """A wedge between two walls that lean apart by an angle from upright: it is
    held by normals alone, unless they are upright."""
    contacts = []
    for side in (-1.0, 1.0):
        for y in (-0.5, 0.5):
            normal = [-side * np.cos(half_angle), 0, np.sin(half_angle)]
            point = [side * 0.5, y, 0]
            contacts.append(
                {"a": 0, "b": -1, "point_m": point, "normal": normal, "friction": friction}
            )
    return {
        "weights_n": [[0, 0, -1]],
        "centres_m": [[0, 0, 0]],
        "radii_m": [1],
        "contacts": contacts,
    }


def leaning(angle, friction):
    """A thin rod between rough floor and smooth wall, leaning by an angle from
    upright: the floor's friction must be tan(angle) / 2."""
    floor = {"a": 0, "b": -1, "point_m": [np.sin(angle), 0, 0], "normal": [0, 0, 1]}
    wall = {"a": 0, "b": -1, "point_m": [0, 0, np.cos(angle)], "normal": [1, 0, 0]}
    centre = [0.5 * np.sin(angle), 0, 0.5 * np.cos(angle)]
    contacts = [{**floor, "friction": friction}, {**wall, "friction": 0.0}]
    return {"weights_n": [[0, 0, -1]], "centres_m": [centre], "radii_m": [1], "contacts": contacts}


def check():
    cases = []
    for angle in (0.3, 0.6):
        cases.append(("block on a slope", block(angle, 0.5), np.tan(angle), 0))
        cases.append(("rod against a wall", leaning(angle, 0.5), np.tan(angle) / 2, 0))
    cases.append(("block on a level floor", block(0.0, 0.5), 0.0, 0))
    cases.append(("wedge that leans", wedge(0.2, 0.5), 0.0, 0))
    cases.append(("block on two corners of one side", block(0.0, 0.5, corners=2), None, 1))
    two = block(0.4, 0.5)
    two["weights_n"].append([0, 0, -1])
    two["centres_m"].append([0, 0, 9])
    cases.append(("block, and one that falls", two, np.tan(0.4), 1))
    failed = 0
    for name, given, friction, fall in cases:
        got = answer(given)
        found = got["least_friction"]
        right = got["fall"] == fall
        if friction is not None:
            right &= found is not None and abs(found - friction) <= PRECISION
        failed += not right
        if not right:
            print(f"FAILS  {name}: expected {friction}, {fall} that fall, got {got}")
    print(f"{len(cases) - failed} of {len(cases)} checks of the certificate hold")
    return failed == 0


if __name__ == "__main__":
    if sys.argv[1:] == ["check"]:
        sys.exit(0 if check() else 1)
    for line in sys.stdin:
        print(json.dumps(answer(json.loads(line))), flush=True)
