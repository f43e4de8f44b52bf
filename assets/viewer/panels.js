// What is written beside the picture: facts, legend, the data of a grain.

import { UNKNOWN, css, gradient } from "./colours.js";
import { MODES, MODE_NAMES } from "./measures.js";

const at = (id) => document.getElementById(id);

function element(name, text, kind) {
  const made = document.createElement(name);
  if (text !== undefined) made.textContent = text;
  if (kind) made.className = kind;
  return made;
}

function counted(count, one) {
  return `${count} ${one}${count === 1 ? "" : "s"}`;
}

export function showFacts(run) {
  at("scenario").textContent = run.scenario;
  const mass = Array.from({ length: run.grains }, (_, n) => run.constants[5 * n + 2]).reduce((a, b) => a + b, 0);
  const stages = counted(run.stages.length, "stage");
  const seen = run.noneKept ? `the end of ${stages}` : `${counted(run.frames.length, "frame")} of ${stages}`;
  at("facts").textContent = `${counted(run.grains, "grain")}, ${mass < 100 ? Number(mass.toPrecision(3)) : mass.toFixed(0)} g; ${seen}`;
  const note = at("frames-note");
  note.hidden = run.kept;
  const ends = run.stages.filter((stage) => !stage.kept).map((stage) => stage.name).join(", ");
  note.textContent = run.noneKept
    ? "This run kept no frames: only the end of each stage can be shown, and nothing in between."
    : `No frames were kept of ${ends}: only the end is shown.`;
  at("colour").append(...MODES.map((mode) => new Option(MODE_NAMES[mode], mode)));
}

export function showLegend(legend) {
  const box = at("legend");
  if (legend.rows) {
    box.replaceChildren(element("div", legend.title, "what"), ...legend.rows.map(swatchOf));
    return;
  }
  box.replaceChildren(
    element("div", legend.title, "what"),
    ...(legend.marks ? [scaleOf(legend.scale), marksOf(legend.marks)] : []),
    ...(legend.unknown ? [swatchOf({ colour: UNKNOWN, ...legend.unknown })] : []),
  );
}

// A colour, what it stands for, and of how many grains.
function swatchOf({ colour, text, count }) {
  const line = element("div", undefined, "swatch"), swatch = element("i");
  swatch.style.background = css(colour);
  line.append(swatch, element("span", text), element("span", String(count), "what"));
  return line;
}

function scaleOf(name) {
  const scale = element("div", undefined, "scale");
  scale.style.background = gradient(name);
  return scale;
}

function marksOf(texts) {
  const marks = element("div", undefined, "marks");
  marks.append(...texts.map((text) => element("span", text)));
  return marks;
}

export function showForces(most, weakest) {
  at("weakest-value").textContent = `${force(weakest)} N`;
  at("forces-legend").replaceChildren(
    element("div", "Force between two bodies, N; the section of a line grows with it", "what"),
    scaleOf("inferno"),
    marksOf(["0", force(most / 2), `${force(most)} +`]),
  );
}

const force = (x) => String(Number(x.toPrecision(2)));

// Numbers of a grain now, with their units, by the names that grains.csv has.
export function dataOf(run, playback, n) {
  // Lengths, volumes and masses of small grains need more decimals: one for each power of ten.
  const decimals = (least, power) => Math.max(least, least - power * Math.round(Math.log10(run.scale)));
  const field = (k) => run.constants[5 * n + k];
  const fraction = run.fractions[field(0)];
  const there = playback.present[n] === 1;
  const [x, y, z] = playback.position(n).map((v) => 1000 * v);
  const exact = 1000 * playback.exactSpeed(n);
  return [
    ["fraction", "Sieve fraction", `${fraction.retained_mm} to ${fraction.passing_mm}`, "mm"],
    ["sieve_size_mm", "Passes a sieve of", field(1).toFixed(decimals(2, 1)), "mm"],
    ["equivalent_diameter_mm", "Equivalent diameter", field(4).toFixed(decimals(2, 1)), "mm"],
    ["volume_mm3", "Volume", field(3).toFixed(decimals(1, 3)), "mm³"],
    ["mass_g", "Mass", field(2).toFixed(decimals(3, 3)), "g"],
    ["x_mm", "x", x.toFixed(decimals(2, 1)), "mm", !there],
    ["y_mm", "y", y.toFixed(decimals(2, 1)), "mm", !there],
    ["z_mm", "z", z.toFixed(decimals(2, 1)), "mm", !there],
    ["speed_mm_per_s", "Speed (laboratory)", exact.toFixed(1), "mm/s", !Number.isFinite(exact)],
    ["relative_speed_mm_per_s", "Speed (to the table)", (1000 * playback.speed(n)).toFixed(1), "mm/s", Number.isNaN(playback.speed(n))],
    ["displacement_mm", "Moved in this stage", (1000 * playback.displacement(n)).toFixed(decimals(2, 1)), "mm", Number.isNaN(playback.displacement(n))],
    ["neighbours", "Grains that touch it", String(playback.stage.coordination[n]), "", !playback.atEnd || !there],
  ];
}

export function showPicked(run, playback, n) {
  at("picked").hidden = n === null;
  if (n === null) return;
  const gone = playback.present[n] ? "" : " (no longer there)";
  const name = `grain_${String(n).padStart(5, "0")}${gone}`;
  if (at("picked-name").textContent !== name) at("picked-name").textContent = name;
  at("picked-data").replaceChildren(...dataOf(run, playback, n).flatMap(([name, label, text, unit, unknown]) => {
    const value = element("dd", unknown ? "–" : `${text} ${unit}`.trim().replace(/^-/, "−"));
    value.dataset.field = name;
    if (!unknown) value.dataset.value = text;
    return [element("dt", label), value];
  }));
}
