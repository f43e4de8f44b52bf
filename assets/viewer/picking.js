// Which grain a ray meets first: exact for convex bodies, whose faces cut the
// ray down to the part inside.

import { cross, dot, normalised, norm, subtract, turnedBack } from "./vectors.js";

export class Picker {
  constructor(run) {
    this.run = run;
    this.bodies = run.shapes.slice(0, run.grains).map(planesOf);
  }

  // `cut` is [nx, ny, nz, d]: what lies beyond n·p = d is not seen.
  pick(playback, origin, direction, cut) {
    let nearest = Infinity, found = null;
    for (let n = 0; n < this.run.grains; n++) {
      if (!playback.present[n]) continue;
      const at = playback.position(n);
      const towards = subtract(at, origin);
      const along = dot(towards, direction);
      const aside2 = dot(towards, towards) - along * along;
      const { radius, planes } = this.bodies[n];
      if (aside2 > radius * radius || along + radius < 0) continue;
      const turn = playback.turns.subarray(4 * n, 4 * n + 4);
      const from = turnedBack(turn, subtract(origin, at)), way = turnedBack(turn, direction);
      let enter = 0, leave = Infinity;
      const limit = (distance, rate) => {
        // Inside where distance + t * rate <= 0.
        if (rate < 0) enter = Math.max(enter, -distance / rate);
        else if (rate > 0) leave = Math.min(leave, -distance / rate);
        else if (distance > 0) leave = -1;
      };
      for (const [normal, offset] of planes) limit(dot(normal, from) - offset, dot(normal, way));
      if (cut) limit(dot(cut, origin) - cut[3], dot(cut, direction));
      if (enter <= leave && enter < nearest) [nearest, found] = [enter, n];
    }
    return found;
  }
}

function planesOf(shape) {
  const vertex = (k) => Array.from(shape.vertices.subarray(3 * k, 3 * k + 3));
  let radius = 0;
  for (let k = 0; k < shape.vertices.length / 3; k++) radius = Math.max(radius, norm(vertex(k)));
  const planes = shape.faces.map((face) => {
    const normal = faceNormal(shape, face);
    return [normal, dot(normal, vertex(face[0]))];
  });
  return { radius, planes };
}

// Unit normal outwards, from all corners (Newell), so that a short edge does no harm.
export function faceNormal(shape, face) {
  const vertex = (k) => Array.from(shape.vertices.subarray(3 * k, 3 * k + 3));
  const first = vertex(face[0]);
  const sum = [0, 0, 0];
  for (let k = 1; k + 1 < face.length; k++) {
    const part = cross(subtract(vertex(face[k]), first), subtract(vertex(face[k + 1]), first));
    part.forEach((x, axis) => { sum[axis] += x; });
  }
  return normalised(sum);
}
