// Reads the block that holds a run; src/viewer/data.rs describes it.

const MAGIC = "PLUVIEW1";
const BEFORE_GRAINS = 40;
const PLACE = 20;

// What stands in a frame's flags.
export const CYLINDER = 1;
export const FUNNEL = 2;
export const LID = 4;
export const PLATE = 8;

// Numbers of a grain in `constants`.
export const CONSTANT_FIELDS = ["fraction", "sieve_size_mm", "mass_g", "volume_mm3", "equivalent_diameter_mm"];

// Equivalent diameter in mm of the middle one of the grains that the page's own lengths were chosen
// for: the paper's.
const OWN_GRAIN_MM = 10;

// How many times as large as those the grains of a run are: every length of the page grows with it.
function grainScale(constants) {
  const fields = CONSTANT_FIELDS.length, sizes = constants.filter((_, k) => k % fields === fields - 1).sort();
  return sizes.length ? sizes[sizes.length >> 1] / OWN_GRAIN_MM : 1;
}

export function parseRun(buffer) {
  const name = new TextDecoder().decode(new Uint8Array(buffer, 0, Math.min(8, buffer.byteLength)));
  if (name !== MAGIC) throw new Error("this is no run that the page can read");
  const length = new DataView(buffer).getUint32(8, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 12, length)));
  if (header.format !== "pluvia-view" || header.version !== 1) {
    throw new Error(`the run has format ${header.format}, version ${header.version}; this page reads pluvia-view, version 1`);
  }
  const base = 12 + length;
  const floats = (s) => new Float32Array(buffer, base + s.offset, s.count);
  const integers = (s) => new Uint32Array(buffer, base + s.offset, s.count);
  const stages = header.stages.map((stage, n) => ({
    number: n,
    name: stage.name,
    kept: stage.kept,
    base: stage.base,
    velocities: floats(stage.velocities_m_per_s),
    coordination: integers(stage.coordination),
    links: readLinks(buffer, base + stage.links.offset, stage.links.count / 8),
    first: 0,
    last: 0,
    start: 0,
    end: 0,
  }));
  const frames = [];
  header.stages.forEach((stage, n) => {
    stages[n].first = frames.length;
    for (let k = 0; k < stage.frames.count; k++) {
      const at = base + stage.frames.offset + k * header.frame_bytes;
      frames.push(readFrame(buffer, at, header.grains, n, header.pieces.length));
    }
    stages[n].last = frames.length - 1;
  });
  for (const stage of stages) {
    stage.end = frames[stage.last].time;
    const before = stage.number > 0 ? stages[stage.number - 1].end : frames[0].time;
    stage.start = stage.kept ? frames[stage.first].time : before;
  }
  return {
    header,
    scenario: header.scenario,
    grains: header.grains,
    fractions: header.fractions,
    constants: floats(header.constants),
    scale: grainScale(floats(header.constants)),
    shapes: readShapes(header.shapes, floats, integers),
    stages,
    frames,
    kept: stages.every((stage) => stage.kept),
    noneKept: stages.every((stage) => !stage.kept),
  };
}

function readFrame(buffer, at, grains, stage, pieces) {
  const view = new DataView(buffer, at);
  return {
    stage,
    time: view.getFloat64(0, true),
    flags: view.getUint32(8, true),
    table: view.getFloat32(12, true),
    opening: view.getFloat32(16, true),
    // Places: the plate's, then the grains', then the pieces'; positions in steps of five 32-bit
    // words, quaternions in steps of ten 16-bit ones.
    positions: new Float32Array(buffer, at + 20, 5 * (grains + pieces + 1)),
    turns: new Int16Array(buffer, at + 20, 10 * (grains + pieces + 1)),
    bytes: BEFORE_GRAINS + PLACE * (grains + pieces),
  };
}

// Where a body is in a frame: 0 is the plate, 1 the first grain.
export function placeOf(frame, body) {
  const p = frame.positions, at = 5 * body;
  return Number.isNaN(p[at]) ? null : [p[at], p[at + 1], p[at + 2]];
}

function readShapes(sections, floats, integers) {
  const vertexCounts = integers(sections.vertex_counts);
  const faceCounts = integers(sections.face_counts);
  const vertices = floats(sections.vertices_m);
  const sizes = integers(sections.face_sizes);
  const corners = integers(sections.corners);
  const shapes = [];
  let vertex = 0, face = 0, corner = 0;
  vertexCounts.forEach((count, n) => {
    const faces = [];
    for (let k = 0; k < faceCounts[n]; k++) {
      faces.push(corners.subarray(corner, corner + sizes[face]));
      corner += sizes[face++];
    }
    shapes.push({ vertices: vertices.subarray(3 * vertex, 3 * (vertex + count)), faces });
    vertex += count;
  });
  return shapes;
}

// What bodies do to each other: the first is a grain, the second one too or a
// number below 0; force on the first in newtons.
function readLinks(buffer, at, count) {
  const view = new DataView(buffer, at, 32 * count);
  return Array.from({ length: count }, (_, n) => {
    const number = (k) => view.getFloat32(32 * n + 8 + 4 * k, true);
    const force = [number(3), number(4), number(5)];
    return {
      a: view.getInt32(32 * n, true),
      b: view.getInt32(32 * n + 4, true),
      point: [number(0), number(1), number(2)],
      size: Math.hypot(...force),
    };
  });
}

// The run inside this page, or beside it on the server.
export async function loadRun() {
  const inside = document.getElementById("run");
  if (inside) {
    const text = atob(inside.textContent);
    const bytes = new Uint8Array(text.length);
    for (let k = 0; k < text.length; k++) bytes[k] = text.charCodeAt(k);
    return parseRun(bytes.buffer);
  }
  const answer = await fetch("run.bin");
  if (!answer.ok) throw new Error(`the run could not be fetched: ${answer.status} ${answer.statusText}`);
  return parseRun(await answer.arrayBuffer());
}
