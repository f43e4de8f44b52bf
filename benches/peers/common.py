"""What the peers written in Python share: arguments, scene, table, samples, result.

A scene is a file in Pluvia's exchange format (docs/exchange.md).
"""

import json
import math
import resource
import sys
import time

SAMPLE_S = 0.08


class Job:
    """SCENE.json RESULT.json RATE_HZ ITERATIONS SECONDS LIMIT_S"""

    def __init__(self, arguments):
        if len(arguments) != 6:
            raise SystemExit(f"six arguments are needed: {self.__doc__}")
        with open(arguments[0]) as file:
            self.scene = json.load(file)
        if (self.scene["format"], self.scene["version"]) != ("pluvia-exchange", 1):
            raise SystemExit(f"{arguments[0]} is no scene of version 1")
        if self.scene["top_plate"] is not None or self.scene["table"]["x_m"] != 0:
            raise SystemExit("this peer reads no top plate and begins with the table in its middle")
        self.result = arguments[1]
        self.rate, self.iterations = float(arguments[2]), int(arguments[3])
        self.seconds, self.limit = float(arguments[4]), float(arguments[5])
        pairs = {tuple(p["between"]): p for p in self.scene["pairs"]}
        self.grain = pairs["grain", "grain"]
        self.wall = pairs["grain", "wall"]
        self.gravity = self.scene["gravity_m_per_s2"]
        self.table = Table(self.scene["table"]["motion"])

    def product_rule(self, what):
        """Values of a grain and of a wall whose products are those of the pairs."""
        grain = math.sqrt(self.grain[what])
        return grain, (self.wall[what] / grain if grain else 0.0)


class Table:
    """x(t) = A sin(2 pi f t), from time 0 on; at rest where there is no motion."""

    def __init__(self, motion):
        self.moves = motion is not None
        self.amplitude = motion["amplitude_m"] if self.moves else 0.0
        self.omega = 2 * math.pi * motion["frequency_hz"] if self.moves else 0.0

    def x(self, t):
        return self.amplitude * math.sin(self.omega * t)

    def velocity(self, t):
        return self.amplitude * self.omega * math.cos(self.omega * t)

    def mean_acceleration(self, t, dt):
        """Over the step from t to t + dt: the velocity gained is exact."""
        return (self.velocity(t + dt) - self.velocity(t)) / dt


class Recorder:
    """Wall time of steps, heights every 0.08 s, and the result."""

    def __init__(self, job, version):
        self.job, self.version = job, version
        self.wall, self.steps, self.time = 0.0, 0, 0.0
        self.series = []
        self.next_sample = SAMPLE_S

    def run(self, dt, step, heights):
        """Calls step(time at its beginning) until the time is over, or the limit of wall time."""
        last = round(self.job.seconds / dt)
        self.sample(heights)
        while self.steps < last and self.wall < self.job.limit:
            began = time.perf_counter()
            step(self.steps * dt)
            self.wall += time.perf_counter() - began
            self.steps += 1
            self.time = self.steps * dt
            if self.time >= self.next_sample - dt / 2 or self.steps == last:
                self.next_sample += SAMPLE_S
                self.sample(heights)

    def sample(self, heights):
        self.series.append({"time_s": self.time, "z_m": [finite(z) for z in heights()]})

    def write(self, poses, table_x):
        """Poses: x, y, z and the quaternion with its scalar last, in the world."""
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        result = {
            "version": self.version,
            "steps": self.steps,
            "simulated_s": self.time,
            "wall_s": self.wall,
            "peak_memory_mib": peak,
            "table_x_m": table_x,
            "poses": [[finite(number) for number in pose] for pose in poses],
            "series": self.series,
        }
        with open(self.job.result, "w") as file:
            json.dump(result, file)


def finite(number):
    number = float(number)
    return number if math.isfinite(number) else None


def arguments():
    """Those after `--` where the interpreter has its own, as Blender has."""
    given = sys.argv[1:]
    return given[given.index("--") + 1 :] if "--" in given else given
