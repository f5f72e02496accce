// A shared replay: plays the recorded scene by a timeline of ours, with the curves, the log and the author's notes.
// viser's player is in the page too, out of sight: its field for the time is what is written into.
"use strict";

(() => {
  const run = window.hectorscopeReplay;
  const { charts: { rowAt, plot, shown }, element } = window.hectorscope;
  const PLAYER = ".mantine-Paper-root .mantine-NumberInput-input";
  const STEP = 100; // milliseconds between two pictures while it plays
  const CAPTION = 4; // seconds that a note stands over the scene
  const setter = Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, "value").set;

  const clock = (seconds) => `${String(Math.floor(seconds / 60)).padStart(2, "0")}:${(seconds % 60).toFixed(1).padStart(4, "0")}`;
  let [now, playing, last, sent] = [0, true, performance.now(), null];

  // ------------------------------------------------------------------------------------------- the player

  function send() {
    const field = document.querySelector(PLAYER);
    const wanted = now.toFixed(2);
    if (!field || sent === wanted) return;
    sent = wanted;
    if (!field.dataset.hsHeld) {
      field.dataset.hsHeld = ""; // it takes the focus with every value: give it back
      field.addEventListener("focus", ({ relatedTarget }) => (relatedTarget ? relatedTarget.focus() : field.blur()));
    }
    setter.call(field, wanted);
    field.dispatchEvent(new Event("input", { bubbles: true }));
  }

  function go(seconds) {
    now = Math.min(Math.max(seconds, 0), run.span);
    draw();
  }

  function play(on) {
    playing = on;
    if (on && now >= run.span) now = 0;
    last = performance.now();
    button.textContent = on ? "❚❚" : "▶";
    button.setAttribute("aria-label", on ? "Pause" : "Play");
  }

  // --------------------------------------------------------------------------------------------- the page

  const button = element("button", { type: "button", onclick: () => play(!playing) });
  const slider = element("input", { type: "range", min: 0, max: run.span, step: 0.05, value: 0, oninput: () => { play(false); go(Number(slider.value)); } });
  slider.setAttribute("aria-label", "Timeline");
  const time = element("output");
  const dots = run.notes.map(([at, text]) => {
    const dot = element("i", { title: text });
    dot.style.left = `${(100 * at) / Math.max(run.span, 1e-9)}%`;
    return dot;
  });
  const foot = element("footer", { className: "hs-foot" }, button, element("div", { className: "hs-track" }, slider, ...dots), time);
  const caption = element("p", { className: "hs-caption", hidden: true });
  caption.setAttribute("role", "status");

  function list(title, lines) {
    const rows = lines.map(([at, level, text]) => {
      const when = element("button", { type: "button", textContent: clock(at), title: "Go there", onclick: () => { play(false); go(at); } });
      return element("li", {}, when, element("span", { className: `hs-${level}`, textContent: text }));
    });
    return { rows, lines, element: element("section", {}, element("h2", { textContent: title }), element("ol", {}, ...rows)) };
  }
  const notes = list("Notes", run.notes.map(([at, text]) => [at, "info", text]));
  const log = list("Log", run.log);

  // ------------------------------------------------------------------------------------------- the curves

  const described = JSON.parse(document.querySelector("[data-hs-charts]").dataset.hsCharts);
  const bytes = Uint8Array.from(atob(run.series), (letter) => letter.charCodeAt(0));
  const table = { values: new Float32Array(bytes.buffer), width: described.widths.series };
  table.count = table.values.length / table.width;
  const colours = getComputedStyle(document.documentElement);
  const series = colours.getPropertyValue("--hs-series").trim().split(/\s+/);
  const colour = ({ colour: name }) => (typeof name === "number" ? series[name % series.length] : colours.getPropertyValue(`--hs-${name}`).trim());
  const span = table.count > 1 ? [table.values[0], table.values[(table.count - 1) * table.width]] : null;

  const figures = run.pages.flatMap((page) => described.pages[page]).map((chart) => {
    const [canvas, cursor, words] = [element("canvas"), element("i", { className: "hs-cursor" }), element("figcaption")];
    canvas.setAttribute("aria-label", chart.title);
    const made = { chart, canvas, cursor, words, shape: null };
    canvas.addEventListener("click", ({ offsetX }) => {
      const { left, right } = made.shape ?? {};
      if (made.shape) go(span[0] + ((offsetX - left) / (right - left)) * (span[1] - span[0]));
    });
    made.element = element("figure", {}, words, element("div", { className: "hs-canvas" }, canvas, cursor));
    return made;
  }).filter(({ chart }) => span && plot.any(table, chart, span));

  const side = element("aside", { className: "hs-side" }, element("h1", { textContent: run.source || "Replay" }));
  if (run.notes.length) side.append(notes.element);
  side.append(element("h2", { textContent: "Curves" }), ...figures.map((made) => made.element), log.element);
  document.body.append(side, foot, caption);

  function curves() {
    for (const made of figures) made.shape = plot.draw(made.canvas, plot.size(made.canvas), table, made.chart, span, made.chart.curves.map(colour));
    draw();
  }

  // ------------------------------------------------------------------------------------------------ time

  function draw() {
    send();
    slider.value = now;
    time.textContent = `${clock(now)} / ${clock(run.span)}`;
    for (const { chart, cursor, words, shape } of figures) {
      const row = rowAt(table, now);
      const values = chart.curves.map((curve) => `${curve.name} ${shown(table.values[row * table.width + curve.column] * chart.factor)}`);
      words.textContent = `${chart.title}: ${values.join(" · ")}`;
      if (shape) cursor.style.left = `${shape.left + ((Math.min(Math.max(now, span[0]), span[1]) - span[0]) / (span[1] - span[0])) * (shape.right - shape.left)}px`;
    }
    for (const { rows, lines } of [notes, log]) {
      const at = lines.findLastIndex(([seconds]) => seconds <= now + 0.05);
      rows.forEach((row, i) => row.setAttribute("aria-current", String(i === at)));
    }
    const told = run.notes.findLast(([seconds]) => seconds <= now + 0.05 && now < seconds + CAPTION);
    caption.hidden = !told;
    if (told && caption.textContent !== told[1]) caption.textContent = told[1];
  }

  setInterval(() => {
    const step = (performance.now() - last) / 1000;
    last = performance.now();
    if (!playing) return send();
    go(now + step);
    if (now >= run.span) play(false);
  }, STEP);
  window.addEventListener("keydown", (event) => {
    const { target } = event;
    if (target === slider || (event.code === "Space" && target.matches?.("button"))) return;
    if (event.code === "Space") play(!playing);
    else if (event.key === "ArrowLeft" || event.key === "ArrowRight") go(now + (event.key === "ArrowLeft" ? -1 : 1));
    else return;
    event.preventDefault();
    event.stopImmediatePropagation();
  }, true);
  new ResizeObserver(curves).observe(side);
  play(true);
  Object.assign(window.hectorscope, { replay: { go, play, now: () => now, playing: () => playing } });
})();
