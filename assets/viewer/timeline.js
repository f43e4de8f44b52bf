// The bar below: play, slider, stages, clock.

// Share of the true speed.
const RATES = [0.05, 0.1, 0.25, 0.5, 1, 2, 4];

// Stages without frames are shown for so long (s), whatever they lasted.
const END_SHOWN = 1;

const byId = (id) => document.getElementById(id);

// `fill_funnel` as people write it.
export function stageName(stage) {
  const words = stage.name.replaceAll("_", " ");
  return words.charAt(0).toUpperCase() + words.slice(1);
}

export class Timeline {
  // `changed` is called after every change of time.
  constructor(run, playback, changed) {
    this.run = run;
    this.playback = playback;
    this.changed = changed;
    this.playing = false;
    this.rate = 1;
    this.waited = 0;
    const slider = byId("slider");
    slider.min = playback.start;
    slider.max = playback.end;
    slider.addEventListener("input", () => {
      this.pause();
      this.go(Number(slider.value));
    });
    const rate = byId("rate");
    rate.append(...RATES.map((x) => new Option(`${x} ×`, x, x === 1, x === 1)));
    rate.addEventListener("change", () => { this.rate = Number(rate.value); });
    rate.disabled = run.noneKept;
    byId("play").addEventListener("click", () => this.toggle());
    byId("back").addEventListener("click", () => this.step(-1));
    byId("on").addEventListener("click", () => this.step(1));
    // Shares in percent: those of a run of less than a second would else not fill the bar.
    const percent = 100 / (playback.end - playback.start || 1);
    this.buttons = run.stages.map((stage) => {
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = stageName(stage);
      const span = `${stage.start.toFixed(2)} to ${stage.end.toFixed(2)} s`;
      button.title = `${stageName(stage)}, ${span}${stage.kept ? "" : ": only its end was kept"}`;
      button.style.flexGrow = Math.max(percent * (stage.end - stage.start), 0.2);
      button.addEventListener("click", () => {
        this.pause();
        // At the very border the end of the stage before is shown.
        this.go(stage.kept && stage.number > 0 ? Math.min(stage.start + 1e-4, stage.end) : stage.kept ? stage.start : stage.end);
      });
      return button;
    });
    byId("stages").append(...this.buttons);
    this.show();
  }

  go(time) {
    this.playback.seek(time);
    this.show();
    this.changed();
  }

  step(direction) {
    this.pause();
    this.playback.step(direction);
    this.show();
    this.changed();
  }

  stepStage(direction) {
    this.pause();
    this.playback.stepStage(direction);
    this.show();
    this.changed();
  }

  toggle() {
    if (this.playing) return this.pause();
    if (this.playback.time >= this.playback.end) this.go(this.playback.start);
    this.playing = true;
    this.waited = 0;
    this.show();
    this.changed();
  }

  pause() {
    this.playing = false;
    this.show();
  }

  // Goes on by a time in seconds as the watcher sees it.
  advance(seconds) {
    if (!this.playing) return;
    const now = this.playback;
    const next = this.run.stages.find((stage) => stage.end > now.time + 1e-6);
    if (next && !next.kept) {
      this.waited += seconds;
      if (this.waited < END_SHOWN) return;
      this.waited = 0;
      now.seek(next.end);
    } else {
      now.seek(now.time + seconds * this.rate);
    }
    if (now.time >= now.end) this.playing = false;
    this.show();
    this.changed();
  }

  show() {
    const { time, stage } = this.playback;
    byId("slider").value = time;
    const spoken = `${time.toFixed(2)} s, ${stageName(stage)}`;
    byId("slider").setAttribute("aria-valuetext", spoken);
    byId("time").textContent = `${time.toFixed(2)} s`;
    byId("stage-name").textContent = stageName(stage);
    byId("play").textContent = this.playing ? "❚❚" : "▶";
    byId("play").setAttribute("aria-label", this.playing ? "Pause" : "Play");
    this.buttons.forEach((button, n) => button.setAttribute("aria-current", String(n === stage.number)));
  }
}
