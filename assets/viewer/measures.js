// What grains are coloured by: a number of each, its unit and its range.

import { UNKNOWN, colourAt, parsed } from "./colours.js";
import { placeOf } from "./data.js";

export const MODES = ["fraction", "displacement", "speed", "height", "coordination"];

export const MODE_NAMES = {
  fraction: "Sieve fraction",
  displacement: "Displacement",
  speed: "Speed",
  height: "Height",
  coordination: "Coordination",
};

// Speeds span decades: falling grains pass 1 m/s, grains at rest stay far below 1 mm/s.
const SPEEDS_MM_PER_S = [1, 1000];

// The next of 1, 2, 5, 10, ... at or above a positive number.
export function niceAbove(x) {
  if (!(x > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(x));
  const step = [1, 2, 5, 10].find((s) => s * power >= x * (1 - 1e-9));
  return step * power;
}

function quantile(values, share) {
  const sorted = values.filter(Number.isFinite).sort((a, b) => a - b);
  return sorted.length ? sorted[Math.round(share * (sorted.length - 1))] : 0;
}

export class Measures {
  constructor(run, playback) {
    this.run = run;
    this.playback = playback;
    this.ranges = new Map();
    this.fractionColours = run.fractions.map((f) => parsed(f.colour));
    this.mostNeighbours = run.stages.reduce((most, s) => s.coordination.reduce((a, b) => Math.max(a, b), most), 1);
  }

  // The number of a grain now, in the unit of the legend; NaN where it is unknown.
  value(mode, n) {
    const now = this.playback;
    switch (mode) {
      case "fraction": return this.run.constants[5 * n];
      case "displacement": return 1000 * now.displacement(n);
      case "speed": return 1000 * now.speed(n);
      case "height": return 1000 * now.positions[3 * n + 2];
      default: return now.atEnd ? now.stage.coordination[n] : NaN;
    }
  }

  // From where to where the colours go. It depends on the stage, not on the
  // time, so that a colour means the same as long as a stage plays.
  range(mode) {
    if (mode === "speed") return SPEEDS_MM_PER_S;
    if (mode === "coordination") return [0, Math.min(this.mostNeighbours, 12)];
    const stage = this.playback.stage, key = `${mode} ${stage.number}`;
    if (!this.ranges.has(key)) this.ranges.set(key, this.rangeIn(mode, stage));
    return this.ranges.get(key);
  }

  // Places of the grains at the beginning and end of a stage.
  placesIn(stage) {
    const { frames, grains } = this.run;
    const places = (frame) => Array.from({ length: grains }, (_, n) => frame && placeOf(frame, n + 1));
    return [this.playback.began(stage), frames[stage.last]].map(places);
  }

  rangeIn(mode, stage) {
    const [from, to] = this.placesIn(stage);
    if (mode === "height") {
      const heights = from.concat(to).map((p) => (p ? 1000 * p[2] : NaN));
      const low = quantile(heights, 0), high = quantile(heights, 1);
      const step = niceAbove((high - low) / 10);
      return [Math.floor(low / step) * step, Math.ceil(high / step) * step];
    }
    const table = this.run.frames[stage.last].table - (this.playback.began(stage)?.table ?? 0);
    const moved = to.map((p, n) => {
      const f = from[n];
      return p && f ? 1000 * Math.hypot(p[0] - f[0] - table, p[1] - f[1], p[2] - f[2]) : NaN;
    });
    return [0, niceAbove(quantile(moved, 0.98))];
  }

  // How many grains at the end of a stage have no displacement in it, and why; null where all have.
  unknownIn(stage) {
    const [from, to] = this.placesIn(stage);
    const known = to.flatMap((place, n) => (place ? [Boolean(from[n])] : []));
    const count = known.filter((is) => !is).length;
    if (count === 0) return null;
    const text = this.playback.began(stage) ? "added since the stage began" : "unknown: no frames were kept";
    return { count, text, all: count === known.length };
  }

  colour(mode, n) {
    const value = this.value(mode, n);
    if (!Number.isFinite(value)) return UNKNOWN;
    if (mode === "fraction") return this.fractionColours[value];
    const [low, high] = this.range(mode);
    const share = mode === "speed"
      ? Math.log(Math.max(value, low) / low) / Math.log(high / low)
      : (value - low) / (high - low || 1);
    return colourAt("viridis", share);
  }

  // Title, unit and marks of the legend; no marks where no grain has a number.
  legend(mode) {
    if (mode === "fraction") {
      const rows = this.run.fractions.map((f, n) => ({
        colour: this.fractionColours[n],
        text: `${f.retained_mm} to ${f.passing_mm} mm`,
        count: f.grains,
      }));
      return { title: "Sieve fraction: retained to passing", rows };
    }
    const [low, high] = this.range(mode);
    const middle = (low + high) / 2;
    const text = (x) => String(Number(x.toPrecision(3)));
    switch (mode) {
      case "displacement": {
        const unknown = this.unknownIn(this.playback.stage);
        const marks = unknown?.all ? null : [text(low), text(middle), `${text(high)} +`];
        return { title: "Displacement since the stage began, relative to the table, mm", scale: "viridis", marks, unknown };
      }
      case "speed":
        return { title: "Speed relative to the table, mean between two frames, mm/s", scale: "viridis", marks: ["≤ 1", "10", "100", "1000 +"] };
      case "height": {
        const zero = this.run.header.pieces.length > 0 ? "z = 0" : "the floor";
        return { title: `Height of the centroid above ${zero}, mm`, scale: "viridis", marks: [text(low), text(middle), text(high)] };
      }
      default:
        return {
          title: "Grains that touch it (coordination number)",
          scale: "viridis",
          marks: ["0", text(middle), `${text(high)}${high < this.mostNeighbours ? " +" : ""}`],
          onlyAtEnds: true,
        };
    }
  }
}
