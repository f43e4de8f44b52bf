// Puts the parts together, and keeps the picture up to date.

import { Camera } from "./camera.js";
import { UNKNOWN, colourAt, linear, parsed } from "./colours.js";
import { CYLINDER, FUNNEL, LID, PLATE, loadRun, placeOf } from "./data.js";
import { MODES, Measures, niceAbove } from "./measures.js";
import { slab } from "./meshes.js";
import { showFacts, showForces, showLegend, showPicked } from "./panels.js";
import { Picker } from "./picking.js";
import { Playback } from "./playback.js";
import { Renderer } from "./renderer.js";
import { Timeline } from "./timeline.js";

const $ = (id) => document.getElementById(id);
const UPRIGHT = [0, 0, 0, 1];
// Colours of the apparatus in sRGB.
const METAL = [0.72, 0.75, 0.78], GLASS = [0.55, 0.68, 0.76], TABLE = { light: [0.6, 0.62, 0.64], dark: [0.34, 0.37, 0.4] };
// A link that bears the largest force has this radius in m among grains of the paper's size; the
// section grows with the force. It and other lengths grow with the grains (`run.scale`).
const THICKEST = 0.0022;

const KEYS = [
  ["Space", "play or pause"], ["← →", "one frame back or on"], ["Shift ← →", "to the end of a stage"],
  ["Home End", "begin, end"], ["1 to 5", "colour by fraction, displacement, speed, height, coordination"],
  ["F", "force chains"], ["G", "grains solid, faint or hidden"], ["C", "cylinder or pieces glass, solid or hidden"],
  ["X", "cut across x, y, from above, none"], ["T", "move along with the table"], ["R", "reset the view"],
  ["Esc", "let go of the grain"], ["?", "these keys"],
];

class Viewer {
  constructor(run) {
    this.run = run;
    this.playback = new Playback(run);
    this.measures = new Measures(run, this.playback);
    this.picker = new Picker(run);
    this.camera = new Camera();
    this.mode = "fraction";
    this.picked = null;
    this.draws = 0;
    this.dirty = true;
    const floor = run.shapes[run.grains].vertices.reduce((low, z, k) => (k % 3 === 2 ? Math.min(low, z) : low), 0);
    const { cylinder, base } = run.header;
    const wide = Math.max(1.9 * cylinder.radius_m, 1.2 * (base?.radius_m ?? 0));
    const table = slab(wide, floor - 0.012 * run.scale, floor - 0.0002 * run.scale);
    this.renderer = new Renderer($("view"), [...run.shapes, table], run.grains);
    showFacts(run);
    this.offerBodies();
    this.timeline = new Timeline(run, this.playback, () => this.change());
    this.listen();
    this.resize();
    this.fit();
    this.change();
    requestAnimationFrame((now) => this.tick(now));
  }

  // Offers what there is to show: the pieces of a laboratory, or what of the apparatus ever stands.
  offerBodies() {
    const seen = this.run.frames.reduce((all, frame) => all | frame.flags, 0);
    const laboratory = this.run.header.pieces.length > 0;
    const there = { cylinder: laboratory || seen & CYLINDER, funnel: seen & FUNNEL, plate: seen & PLATE };
    for (const [id, shown] of Object.entries(there)) {
      const label = document.querySelector(`label[for="${id}"]`);
      if (laboratory && id === "cylinder") label.textContent = "Pieces";
      label.hidden = $(id).hidden = !shown;
    }
  }

  listen() {
    new ResizeObserver(() => this.resize()).observe($("view"));
    this.camera.listen($("view"), () => { this.dirty = true; }, (x, y) => this.pick(this.pickAt(x, y)));
    for (const id of ["grains", "cylinder", "funnel", "plate", "cut-axis", "cut", "still", "weakest"]) {
      $(id).addEventListener("input", () => this.change());
    }
    $("colour").addEventListener("change", () => this.setColour($("colour").value));
    $("forces").addEventListener("change", () => this.setForces($("forces").checked));
    $("unpick").addEventListener("click", () => this.pick(null));
    $("to-end").addEventListener("click", () => this.toStageEnd());
    $("reset").addEventListener("click", () => this.reset());
    $("theme").addEventListener("click", () => this.setTheme(this.theme === "dark" ? "light" : "dark"));
    $("help").addEventListener("click", () => $("keys").showModal());
    $("toggle").addEventListener("click", () => {
      const open = $("controls").classList.toggle("open");
      $("toggle").setAttribute("aria-expanded", String(open));
      $("toggle").textContent = open ? "Close" : "Options";
      this.refit();
    });
    $("keys-list").append(...KEYS.flatMap(([key, what]) => {
      const [dt, dd] = ["dt", "dd"].map((name) => document.createElement(name));
      [dt.textContent, dd.textContent] = [key, what];
      return [dt, dd];
    }));
    const dark = matchMedia("(prefers-color-scheme: dark)");
    dark.addEventListener("change", () => this.setTheme(dark.matches ? "dark" : "light"));
    this.setTheme(dark.matches ? "dark" : "light");
    document.addEventListener("keydown", (event) => this.key(event));
    $("view").addEventListener("webglcontextlost", (event) => {
      event.preventDefault();
      trouble("The graphics card has dropped the picture. Load the page again.");
    });
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || $("keys").open) return;
    // Keys that the control in use understands itself.
    const own = { INPUT: /^(Arrow.*|Home|End| )$/, SELECT: /^(Arrow.*|Home|End|.)$/, BUTTON: /^( |Enter)$/ };
    if (own[event.target.tagName]?.test(event.key)) return;
    const direction = event.key === "ArrowRight" ? 1 : -1;
    const next = (id) => {
      $(id).selectedIndex = ($(id).selectedIndex + 1) % $(id).options.length;
      this.change();
    };
    const actions = {
      " ": () => this.timeline.toggle(),
      ArrowRight: () => (event.shiftKey ? this.timeline.stepStage(direction) : this.timeline.step(direction)),
      ArrowLeft: () => (event.shiftKey ? this.timeline.stepStage(direction) : this.timeline.step(direction)),
      Home: () => this.timeline.go(this.playback.start),
      End: () => this.timeline.go(this.playback.end),
      f: () => this.setForces(!$("forces").checked),
      g: () => next("grains"),
      c: () => next("cylinder"),
      x: () => next("cut-axis"),
      t: () => { $("still").checked = !$("still").checked; this.change(); },
      r: () => this.reset(),
      Escape: () => this.pick(null),
      "?": () => $("keys").showModal(),
    };
    MODES.forEach((mode, n) => { actions[n + 1] = () => this.setColour(mode); });
    const action = actions[event.key] ?? actions[event.key.toLowerCase()];
    if (!action) return;
    event.preventDefault();
    action();
  }

  get theme() {
    return document.documentElement.dataset.theme;
  }

  setTheme(theme) {
    document.documentElement.dataset.theme = theme;
    this.change();
  }

  setColour(mode) {
    this.mode = mode;
    $("colour").value = mode;
    this.change();
  }

  // Grains make way for the forces between them.
  setForces(on) {
    $("forces").checked = on;
    if (on && $("grains").value === "solid") $("grains").value = "faint";
    else if (!on && $("grains").value === "faint") $("grains").value = "solid";
    this.change();
  }

  pick(grain) {
    this.picked = grain;
    this.change();
    this.refit();
  }

  toStageEnd() {
    this.timeline.pause();
    this.timeline.go(this.playback.stage.end);
  }

  // After panels came or went; a view that the watcher chose stays.
  refit() {
    if (!this.camera.moved) this.fit();
    this.dirty = true;
  }

  reset() {
    this.camera.azimuth = -1.05;
    this.camera.elevation = 0.34;
    this.fit();
    this.dirty = true;
  }

  // The middle and radius of what is there in this stage.
  get scene() {
    const number = this.playback.stage.number;
    this.scenes ??= [];
    return (this.scenes[number] ??= this.sceneNow());
  }

  sceneNow() {
    const { cylinder, funnel, base } = this.run.header;
    const { frames, scale } = this.run, { stage } = this.playback;
    const last = frames[stage.last], first = frames[stage.first];
    let low = Infinity, high = -Infinity, wide = 0;
    const hold = (from, to, radius) => {
      low = Math.min(low, from);
      high = Math.max(high, to);
      wide = Math.max(wide, radius);
    };
    if ((first.flags | last.flags) & CYLINDER) hold(-0.02 * scale, cylinder.height_m, cylinder.radius_m + 0.02 * scale);
    if (stage.base) hold(-0.02 * scale, 0.01 * scale, base.radius_m);
    for (const frame of [first, last]) {
      if (frame.flags & FUNNEL) hold(frame.opening, frame.opening + funnel.height_m, funnel.top_radius_m);
    }
    for (const frame of [first, last]) {
      this.run.header.piece_radii_m.forEach((radius, k) => {
        const place = placeOf(frame, this.run.grains + 1 + k);
        if (place) hold(place[2] - radius, place[2] + radius, Math.hypot(place[0], place[1]) + radius);
      });
    }
    for (const frame of [first, last]) {
      for (let n = 1; n <= this.run.grains; n++) {
        const place = placeOf(frame, n);
        // Spilled grains may lie anywhere.
        if (place && Math.hypot(place[0], place[1]) < 2 * wide) hold(place[2] - 0.01 * scale, place[2] + 0.01 * scale, 0);
      }
    }
    if (low > high) hold(0, cylinder.height_m, cylinder.radius_m);
    const half = (high - low) / 2;
    return { centre: [0, 0, (low + high) / 2], wide, half, radius: Math.hypot(half, wide) };
  }

  // Brings what is there into the part of the picture that no panel covers.
  fit() {
    const [width, height] = this.camera.size;
    const narrow = width <= 760;
    const panels = ["bar", ...(narrow ? ["controls", "picked"] : [])].map((id) => $(id).getBoundingClientRect());
    const lowest = panels.filter((box) => box.height > 0).reduce((y, box) => Math.min(y, box.top), height);
    const right = narrow ? 0 : Math.min(310 / width, 0.4);
    // Facts that reach near the middle of what is seen would stand before it.
    const head = $("head").getBoundingClientRect();
    const top = narrow || head.right > 0.42 * (1 - right) * width ? head.bottom : 12;
    this.camera.covered = {
      right,
      top: Math.min(top / height, 0.3),
      bottom: Math.min((height - lowest) / height, 0.6),
    };
    const { centre, wide, half } = this.scene;
    this.camera.fit(centre, wide, half);
    this.framed = this.playback.stage.number;
  }

  resize() {
    const canvas = $("view"), ratio = Math.min(devicePixelRatio || 1, 2);
    const size = [canvas.clientWidth, canvas.clientHeight];
    canvas.width = Math.max(Math.round(size[0] * ratio), 1);
    canvas.height = Math.max(Math.round(size[1] * ratio), 1);
    this.camera.size = size.map((x) => Math.max(x, 1));
    this.refit();
  }

  // What the picture is moved by, along x, when the watcher goes with the table.
  get shift() {
    return $("still").checked ? -this.playback.table : 0;
  }

  get cut() {
    const axis = "xyz".indexOf($("cut-axis").value || "-");
    if (axis < 0) return null;
    const share = Number($("cut").value);
    const { cylinder, base, funnel } = this.run.header;
    const pile = this.playback.stage.base;
    const [r, h] = pile ? [base.radius_m, base.radius_m] : [cylinder.radius_m, cylinder.height_m];
    const top = this.playback.flags & FUNNEL ? this.playback.opening + funnel.height_m : h;
    const normal = [0, 0, 0];
    // Half of what is between the watcher and the middle goes first.
    const sign = axis === 2 || this.camera.back[axis] >= 0 ? 1 : -1;
    normal[axis] = sign;
    const place = axis === 2 ? share * top : (2 * share - 1) * r * 1.3;
    const moved = axis === 0 ? this.playback.table + this.shift : 0;
    return { plane: [...normal, sign * (place + moved)], place };
  }

  pickAt(x, y) {
    if ($("grains").value === "hidden") return null;
    const [origin, direction] = this.camera.ray(x, y);
    const plane = this.cut?.plane;
    // Grains are where the picture shows them less what the picture is moved by.
    const from = [origin[0] - this.shift, origin[1], origin[2]];
    const cut = plane && [...plane.slice(0, 3), plane[3] - plane[0] * this.shift];
    return this.picker.pick(this.playback, from, direction, cut);
  }

  // Everything that depends on time and settings.
  change() {
    const now = this.playback;
    if (!this.camera.moved && this.framed !== now.stage.number) this.fit();
    const cut = this.cut;
    $("cut").disabled = !cut;
    $("cut-value").textContent = cut ? `${Number((1000 * cut.place).toPrecision(3))} mm` : "";
    const legend = `${this.mode} ${now.stage.number}`;
    if (legend !== this.legend) showLegend(this.measures.legend(this.mode));
    this.legend = legend;
    showPicked(this.run, now, this.picked);
    const forces = $("forces").checked;
    const known = now.stage.links.length > 0;
    $("forces-more").hidden = !(forces && known);
    $("no-forces").hidden = !forces || known;
    $("ends-note").hidden = now.atEnd || !(forces || this.mode === "coordination");
    this.place();
    this.renderer.setLinks(forces && now.atEnd ? this.linkNumbers() : new Float32Array(0));
    if (forces) showForces(this.mostForce(), this.weakest());
    this.dirty = true;
  }

  place() {
    const now = this.playback, { grains, header } = this.run, { renderer, shift } = this;
    for (let n = 0; n < grains; n++) {
      const p = now.positions, at = 3 * n;
      const seen = now.present[n] === 1;
      const colour = seen ? linear(this.measures.colour(this.mode, n)) : UNKNOWN;
      renderer.setBody(n, seen, [p[at] + shift, p[at + 1], p[at + 2]], now.turns.subarray(4 * n, 4 * n + 4), colour, n === this.picked);
    }
    const colourOf = (id, solid) => linear($(id).value === "glass" ? GLASS : solid);
    const table = now.table + shift, funnel = [shift, 0, now.opening];
    const body = (name) => grains + header.apparatus.indexOf(name);
    renderer.setBody(body("cylinder"), now.flags & CYLINDER, [table, 0, 0], UPRIGHT, colourOf("cylinder", METAL));
    renderer.setBody(body("funnel"), now.flags & FUNNEL, funnel, UPRIGHT, colourOf("funnel", METAL));
    renderer.setBody(body("lid"), now.flags & LID, funnel, UPRIGHT, colourOf("funnel", METAL));
    if (header.base) renderer.setBody(body("base"), now.stage.base, [shift, 0, 0], UPRIGHT, linear(METAL));
    const plate = now.flags & PLATE ? now.plate : null;
    const at = plate ? [plate.position[0] + shift, plate.position[1], plate.position[2]] : null;
    renderer.setBody(body("top_plate"), plate !== null, at, plate?.turn, colourOf("plate", parsed(header.plate_colour)));
    now.pieces.forEach((place, k) => {
      const at = place && [place[0] + shift, place[1], place[2]];
      renderer.setBody(body(`piece_${k}`), place !== null, at, place?.slice(3), colourOf("cylinder", METAL));
    });
    // The table is that of the cylinder.
    const tableSeen = header.pieces.length === 0;
    renderer.setBody(grains + header.apparatus.length, tableSeen, [table, 0, 0], UPRIGHT, linear(TABLE[this.theme]));
  }

  // The colours of forces end at this many newtons: a few carry far more than the others.
  mostForce() {
    const sizes = this.playback.stage.links.map((link) => link.size).sort((a, b) => a - b);
    return niceAbove(sizes.length ? sizes[Math.floor(0.99 * (sizes.length - 1))] : 0);
  }

  weakest() {
    // Even steps of the slider are even steps of a line's width.
    return this.mostForce() * Number($("weakest").value) ** 2;
  }

  linkNumbers() {
    const now = this.playback, most = this.mostForce(), weakest = this.weakest();
    const numbers = [];
    const moved = (p) => [p[0] + this.shift, p[1], p[2]];
    for (const link of now.stage.links) {
      if (link.size < weakest || !now.present[link.a] || (link.b >= 0 && !now.present[link.b])) continue;
      const share = Math.min(link.size / most, 1);
      const to = link.b >= 0 ? now.position(link.b) : link.point;
      numbers.push(...moved(now.position(link.a)), THICKEST * this.run.scale * Math.sqrt(share), ...moved(to), ...linear(colourAt("inferno", share)));
    }
    this.shown = numbers.length / 10;
    return new Float32Array(numbers);
  }

  tick(now) {
    // A hidden page must not leap when it is seen again.
    const passed = Math.min((now - (this.before ?? now)) / 1000, 0.25);
    this.before = now;
    this.timeline.advance(passed);
    if (this.dirty) {
      this.dirty = false;
      this.draw();
    }
    requestAnimationFrame((next) => this.tick(next));
  }

  draw() {
    const { grains, header } = this.run;
    const how = (name) => (name === "base" ? "solid" : name === "lid" ? $("funnel").value : name === "top_plate" ? $("plate").value : name.startsWith("piece_") ? $("cylinder").value : $(name).value);
    const apparatus = header.apparatus.map((name, n) => ({ body: grains + n, how: how(name), shadow: true }));
    apparatus.push({ body: grains + apparatus.length, how: "solid", shadow: false });
    const dark = this.theme === "dark";
    this.renderer.draw(this.camera, {
      grains: $("grains").value,
      apparatus,
      cut: this.cut?.plane ?? null,
      picked: this.picked !== null && this.playback.present[this.picked] ? this.picked : null,
      scene: this.scene,
      scale: this.run.scale,
      background: dark ? [0.082, 0.098, 0.11] : [0.925, 0.937, 0.945],
      line: linear(dark ? [0.85, 0.92, 0.96] : [0.2, 0.3, 0.36]),
    });
    this.draws++;
  }
}

function trouble(text) {
  $("trouble").hidden = false;
  $("trouble-text").textContent = text;
}

// What tests and the curious may use, from the browser's console.
const outside = { ready: false, error: null };
window.pluvia = outside;

function offer(viewer) {
  const { run, playback, timeline } = viewer;
  const values = {
    time: () => playback.time, start: () => playback.start, end: () => playback.end,
    stage: () => playback.stage.name, atStageEnd: () => playback.atEnd, playing: () => timeline.playing,
    frames: () => run.frames.length, grains: () => run.grains, kept: () => run.kept, picked: () => viewer.picked,
    scale: () => run.scale, colour: () => viewer.mode, draws: () => viewer.draws, links: () => viewer.renderer.links,
    covered: () => viewer.camera.covered,
  };
  for (const [name, get] of Object.entries(values)) Object.defineProperty(outside, name, { get, enumerable: true });
  Object.assign(outside, {
    seek: (time) => timeline.go(time),
    pick: (grain) => viewer.pick(grain),
    pickAt: (x, y) => viewer.pickAt(x, y),
    positionOf: (grain) => playback.position(grain),
    screenOf: (grain) => {
      const [x, y, z] = playback.position(grain);
      return viewer.camera.onScreen([x + viewer.shift, y, z]);
    },
    colourOf: (grain) => viewer.measures.colour(viewer.mode, grain),
  });
}

async function begin() {
  try {
    const run = await loadRun();
    // Kept apart from the run's own faults: the watcher can fix this one.
    if (!document.createElement("canvas").getContext("webgl2")) {
      outside.error = "no WebGL 2";
      return trouble("The browser offers no WebGL 2, with which this page draws. Switch hardware acceleration on in its settings, or take another browser: Firefox, Chromium, Chrome, Edge and Safari of recent years have it.");
    }
    offer(new Viewer(run));
    outside.ready = true;
  } catch (error) {
    outside.error = String(error.message ?? error);
    trouble(outside.error);
  }
}

begin();
