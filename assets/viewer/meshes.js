// Triangles of the bodies: each face as a fan about its middle, so that every
// triangle knows how far it is from the one edge of the face that it has.

import { add, cross, dot, norm, normalised, scaled, subtract } from "./vectors.js";
import { faceNormal } from "./picking.js";

// Floats a vertex: corner, normal, distance from the edge in m, number of the body.
export const STRIDE = 8;

// Faces that meet at less than this angle are parts of one round surface.
const SMOOTH = Math.cos((30 * Math.PI) / 180);

// Distance that no line reaches.
const NO_EDGE = 1;

const rounded = (p) => p.map((x) => Math.round(x * 1e6)).join();

// Vertices of all shapes, and where each shape begins: [first vertex, count].
export function buildMesh(shapes, grains) {
  const size = shapes.reduce((sum, s) => sum + s.faces.reduce((corners, f) => corners + 3 * f.length, 0), 0);
  const out = new Float32Array(STRIDE * size);
  const ranges = [];
  let vertex = 0;
  shapes.forEach((shape, body) => {
    const first = vertex;
    const round = body >= grains ? roundness(shape) : null;
    const at = (k) => Array.from(shape.vertices.subarray(3 * k, 3 * k + 3));
    const put = (p, normal, edge) => {
      out.set([...p, ...normal, edge, body], STRIDE * vertex);
      vertex++;
    };
    for (const face of shape.faces) {
      const flat = faceNormal(shape, face);
      const corners = Array.from(face, at);
      const middle = scaled(corners.reduce(add), 1 / corners.length);
      corners.forEach((a, k) => {
        const b = corners[(k + 1) % corners.length];
        const length = norm(subtract(b, a)) || 1;
        const sharp = !round || round.sharp(a, b);
        const far = norm(cross(subtract(middle, a), subtract(b, a))) / length;
        const normalAt = (p) => (round ? round.normal(p, flat) : flat);
        put(middle, flat, sharp ? far : NO_EDGE);
        put(a, normalAt(a), sharp ? 0 : NO_EDGE);
        put(b, normalAt(b), sharp ? 0 : NO_EDGE);
      });
    }
    ranges.push([first, vertex - first]);
  });
  return { vertices: out, ranges };
}

// Which edges of a shape are sharp, and the normals of its round parts.
function roundness(shape) {
  const atCorner = new Map(), atEdge = new Map();
  const keep = (map, key, normal) => {
    if (!map.has(key)) map.set(key, []);
    map.get(key).push(normal);
  };
  const edge = (a, b) => [rounded(a), rounded(b)].sort().join(" ");
  for (const face of shape.faces) {
    const normal = faceNormal(shape, face);
    const corners = Array.from(face, (k) => Array.from(shape.vertices.subarray(3 * k, 3 * k + 3)));
    corners.forEach((a, k) => {
      keep(atCorner, rounded(a), normal);
      keep(atEdge, edge(a, corners[(k + 1) % corners.length]), normal);
    });
  }
  return {
    sharp(a, b) {
      const normals = atEdge.get(edge(a, b));
      return normals.some((n) => normals.some((m) => dot(n, m) < SMOOTH));
    },
    normal(p, flat) {
      const near = atCorner.get(rounded(p)).filter((n) => dot(n, flat) > SMOOTH);
      return normalised(near.reduce(add, [0, 0, 0]));
    },
  };
}

// A round slab: the shaking table.
export function slab(radius, bottom, top) {
  const sides = 96, vertices = [], faces = [];
  for (let k = 0; k < sides; k++) {
    const angle = (2 * Math.PI * k) / sides;
    const [x, y] = [radius * Math.cos(angle), radius * Math.sin(angle)];
    vertices.push(x, y, bottom, x, y, top);
    const next = (k + 1) % sides;
    faces.push([2 * k, 2 * next, 2 * next + 1, 2 * k + 1]);
  }
  faces.push(Array.from({ length: sides }, (_, k) => 2 * k + 1));
  faces.push(Array.from({ length: sides }, (_, k) => 2 * (sides - 1 - k)));
  return { vertices: new Float32Array(vertices), faces };
}

// A prism about the z axis from 0 to 1, for links.
export function prism(sides) {
  const out = [];
  for (let k = 0; k < sides; k++) {
    const [a, b] = [k, k + 1].map((s) => [Math.cos((2 * Math.PI * s) / sides), Math.sin((2 * Math.PI * s) / sides)]);
    out.push(...a, 0, ...b, 0, ...b, 1, ...a, 0, ...b, 1, ...a, 1);
  }
  return new Float32Array(out);
}
