// Where everything is at a time: between two frames of a stage on a straight
// line, and turned evenly (normalised linear interpolation of quaternions).

import { placeOf } from "./data.js";

// Times nearer than this (s) are the same.
const SAME_TIME = 1e-6;

export class Playback {
  constructor(run) {
    this.run = run;
    this.start = run.frames[0].time;
    this.end = run.frames[run.frames.length - 1].time;
    this.positions = new Float32Array(3 * run.grains);
    this.turns = new Float32Array(4 * run.grains);
    this.present = new Uint8Array(run.grains);
    // It opens on the finished specimen.
    this.seek(this.end);
  }

  // At the border of two stages this shows the end of the first.
  seek(time) {
    const { frames } = this.run;
    this.time = Math.min(Math.max(time, this.start), this.end);
    let low = 0, high = frames.length - 1;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (frames[middle].time >= this.time - SAME_TIME) high = middle; else low = middle + 1;
    }
    const after = frames[low], before = frames[Math.max(low - 1, 0)];
    const there = Math.abs(after.time - this.time) <= SAME_TIME;
    const within = before.stage === after.stage && after.time - before.time > SAME_TIME;
    this.frame = there ? low : Math.max(low - 1, 0);
    this.stage = this.run.stages[there || within ? after.stage : before.stage];
    // The two frames that a speed can be read from.
    this.interval = within ? [before, after] : null;
    if (there) this.blend(after, after, 0);
    else if (within) this.blend(before, after, (this.time - before.time) / (after.time - before.time));
    else this.blend(before, before, 0);
  }

  blend(a, b, share) {
    const plate = this.place(a, b, 0, share);
    this.plate = plate && { position: plate.slice(0, 3), turn: plate.slice(3) };
    for (let n = 0; n < this.run.grains; n++) {
      const place = this.place(a, b, n + 1, share);
      this.present[n] = place ? 1 : 0;
      if (!place) continue;
      this.positions.set(place.slice(0, 3), 3 * n);
      this.turns.set(place.slice(3), 4 * n);
    }
    const { grains, header } = this.run;
    this.pieces = header.pieces.map((_, k) => this.place(a, b, grains + 1 + k, share));
    this.flags = a.flags;
    this.table = a.table + share * (b.table - a.table);
    this.opening = a.opening;
  }

  // Position and quaternion of a body; one that vanishes is there until it does.
  place(a, b, body, share) {
    const p = a.positions, q = a.turns, i = 5 * body, k = 10 * body + 6;
    if (Number.isNaN(p[i])) return null;
    const r = Number.isNaN(b.positions[i]) ? p : b.positions;
    const s = r === p ? q : b.turns;
    // The shorter way round: q and -q are the same turn.
    const same = q[k] * s[k] + q[k + 1] * s[k + 1] + q[k + 2] * s[k + 2] + q[k + 3] * s[k + 3];
    const to = same < 0 ? -share : share, from = 1 - share;
    const x = from * q[k] + to * s[k], y = from * q[k + 1] + to * s[k + 1];
    const z = from * q[k + 2] + to * s[k + 2], w = from * q[k + 3] + to * s[k + 3];
    const length = Math.hypot(x, y, z, w) || 1;
    return [
      from * p[i] + share * r[i], from * p[i + 1] + share * r[i + 1], from * p[i + 2] + share * r[i + 2],
      x / length, y / length, z / length, w / length,
    ];
  }

  position(grain) {
    return Array.from(this.positions.subarray(3 * grain, 3 * grain + 3));
  }

  // Whether this is the end of a stage, where contacts and exact speeds are known.
  get atEnd() {
    return Math.abs(this.stage.end - this.time) <= SAME_TIME;
  }

  // Mean speed in m/s between the two frames around this time, relative to the
  // table; NaN where it cannot be told.
  speed(grain) {
    if (!this.interval) return NaN;
    const [a, b] = this.interval;
    const from = placeOf(a, grain + 1), to = placeOf(b, grain + 1);
    if (!from || !to) return NaN;
    const dx = to[0] - b.table - (from[0] - a.table);
    return Math.hypot(dx, to[1] - from[1], to[2] - from[2]) / (b.time - a.time);
  }

  // Speed in m/s that the engine gave, in the laboratory; NaN but at the end of a stage.
  exactSpeed(grain) {
    if (!this.atEnd || !this.present[grain]) return NaN;
    const v = this.stage.velocities;
    return Math.hypot(v[3 * grain], v[3 * grain + 1], v[3 * grain + 2]);
  }

  // The frame at which a stage began: its first, else the end of the one before; null where neither
  // was kept.
  began(stage) {
    return this.run.frames[stage.kept ? stage.first : stage.first - 1] ?? null;
  }

  // Distance in m from where the grain was when the stage began, relative to the table; NaN where
  // that is unknown.
  displacement(grain) {
    if (!this.present[grain]) return NaN;
    const frame = this.began(this.stage);
    const from = frame && placeOf(frame, grain + 1);
    if (!from) return NaN;
    const p = this.positions, at = 3 * grain;
    const dx = p[at] - this.table - (from[0] - frame.table);
    return Math.hypot(dx, p[at + 1] - from[1], p[at + 2] - from[2]);
  }

  // One frame on (1) or back (-1).
  step(direction) {
    const { frames } = this.run;
    let n = this.frame;
    const between = this.time > frames[n].time + SAME_TIME;
    if (!(between && direction < 0)) {
      do n += direction; while (frames[n] && Math.abs(frames[n].time - this.time) <= SAME_TIME);
    }
    this.seek(frames[Math.min(Math.max(n, 0), frames.length - 1)].time);
  }

  // The next end of a stage, or the one before.
  stepStage(direction) {
    const ends = this.run.stages.map((stage) => stage.end);
    const found = direction > 0
      ? ends.find((end) => end > this.time + SAME_TIME)
      : ends.filter((end) => end < this.time - SAME_TIME).pop();
    this.seek(found ?? (direction > 0 ? this.end : this.start));
  }
}
