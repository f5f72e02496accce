// The timeline over the whole recording, or over what is kept of a stream: what is known of it, its marks, and below them a strip of one chart, so that
// a bad place is seen before it is sought. A hand drags it anywhere; the newest wanted time is sent, some times a second.
// panels/timeline.py sends where the run is and the marks; the rows are those of plots.js.
"use strict";

(() => {
  const { own, charts } = window.hectorscope;
  const TICK = 200; // milliseconds between two looks for something new to draw
  const SENDING = 50; // and between two wanted times that are sent
  const HOLD = 2000; // for so long the head stays where a hand has put it, if the run does not arrive there
  const NEAR = 7; // pixels around a mark that belong to it
  const LANES = { marks: 8, track: 18, strip: 27 }; // pixels from the top: middle of the marks, track, strip
  const ARROWS = { ArrowLeft: -1, ArrowRight: 1, PageDown: -10, PageUp: 10, Home: -Infinity, End: Infinity };
  // Each kind has a shape of its own: colour alone tells nothing. The gravest are drawn last, over the others.
  const SHAPES = {
    setting: ["text", "M-3.5-3.5h7v7h-7z"],
    finding: ["position", "M0-5.5 1.5-1.6 5.6-1.6 2.3 1 3.4 5 0 2.6-3.4 5-2.3 1-5.6-1.6-1.5-1.6z"],
    recovered: ["accent", "M4 0A4 4 0 1 1-4 0 4 4 0 1 1 4 0z"],
    weak: ["prior", "M0-5 2.5 0 0 5-2.5 0z"],
    degenerate: ["prior", "M0-5 5 0 0 5-5 0z"],
    gap: ["muted", "M-5-3h2.5v6H-5zM2.5-3H5v6H2.5z"],
    warning: ["warning", "M0-5 5 4H-5z"],
    bad_match: ["warning", "M0 5 5-4H-5z"],
    lost: ["error", "M-5-3.2-3.2-5 0-1.8 3.2-5 5-3.2 1.8 0 5 3.2 3.2 5 0 1.8-3.2 5-5 3.2-1.8 0z"],
  };
  const paths = Object.fromEntries(Object.entries(SHAPES).map(([kind, [, path]]) => [kind, new Path2D(path)]));

  let told = null; // by the server: uuids of its controls, titles of the kinds
  let run = { at: 0, begin: 0, end: null, known: 0, whole: false, rows: 0, state: "loading" };
  let marks = [];
  let answered = () => {}; // ends the asking for what a page that was opened or connected again needs
  let wanted = null; // seconds: where a hand wants to be
  let wantedAt = 0;
  let sent = { value: null, at: 0, count: 0 };
  let drawn = "";

  const bar = document.createElement("div");
  bar.className = "hs-timeline-inner";
  bar.innerHTML = `
    <button type="button" class="hs-tool" title="Mark before · Shift N" aria-label="Mark before"><svg viewBox="0 0 24 24"><path d="M17 6l-8 6 8 6zM7 6v12"/></svg></button>
    <div class="hs-timeline-track" role="slider" tabindex="0" aria-label="Timeline" aria-valuemin="0"><canvas></canvas><i class="hs-playhead"></i><i class="hs-timeline-cursor" hidden></i></div>
    <button type="button" class="hs-tool" title="Next mark · N" aria-label="Next mark"><svg viewBox="0 0 24 24"><path d="M7 6l8 6-8 6zM17 6v12"/></svg></button>
    <select class="hs-strip" data-hs-own="strip" aria-label="Strip" title="What the strip below the timeline shows"></select>`;
  const [before, track, next, choice] = bar.children;
  const [canvas, head, cursor] = track.children;
  const tip = Object.assign(document.createElement("div"), { className: "hs-timeline-tip", hidden: true });
  document.body.append(tip);

  // ---------------------------------------------------------------------------------------------- times

  const share = (seconds) => (run.end > run.begin ? Math.min(Math.max((seconds - run.begin) / (run.end - run.begin), 0), 1) : 0);
  const clock = (seconds) => `${String(Math.floor(seconds / 60)).padStart(2, "0")}:${(seconds % 60).toFixed(1).padStart(4, "0")}`;

  function timeAt({ clientX }) {
    const box = track.getBoundingClientRect();
    const part = box.width ? Math.min(Math.max(clientX - box.left, 0), box.width) / box.width : 0;
    return run.begin + part * (run.end - run.begin);
  }

  // Goes to a time. The server takes a value only if it is another one: it differs by less than a microsecond.
  function seek(seconds) {
    if (seconds === null || !Number.isFinite(seconds) || run.end === null || !told) return;
    want(seconds);
    const value = wanted + 1e-7 * (sent.count = (sent.count % 7) + 1);
    sent = { ...sent, value: wanted, at: performance.now() };
    window.__viserMutable?.sendMessage?.({ type: "GuiUpdateMessage", uuid: told.wanted, updates: { value } });
    window.hectorscope.jump.begin(wanted);
  }

  function want(seconds) {
    [wanted, wantedAt] = [Math.min(Math.max(seconds, run.begin), run.end), performance.now()];
    place();
  }

  // The next mark from where the run is, or will be; -1: the one before.
  function step(way) {
    const from = wanted ?? run.at;
    const there = marks.map(([seconds]) => seconds).filter((seconds) => seconds >= run.begin && (seconds - from) * way > 0.02);
    if (there.length) seek(way > 0 ? Math.min(...there) : Math.max(...there));
  }

  function play(now) {
    answered();
    const rows = now.rows !== run.rows;
    run = now;
    if (rows) window.hectorscope.plotted?.().show(now.rows);
    place();
  }

  // The head goes with the run again once that is where a hand wanted it. A run at rest says so only once: it is looked for.
  function arrive() {
    const since = performance.now() - wantedAt;
    if (wanted === null || dragging || run.state === "seeking" || since < TICK) return;
    if (Math.abs(run.at - wanted) >= 0.3 && since < HOLD) return;
    wanted = null;
    place();
  }

  function place() {
    const shown = wanted ?? run.at;
    head.style.left = `${100 * share(shown)}%`;
    track.setAttribute("aria-valuemin", String(run.begin));
    track.setAttribute("aria-valuemax", String(run.end ?? 0));
    track.setAttribute("aria-valuenow", String(shown));
    track.setAttribute("aria-valuetext", clock(shown));
  }

  // --------------------------------------------------------------------------------------------- drawing

  const pages = () => window.hectorscope.plotted?.().pages ?? {};
  const chosen = () => Object.values(pages()).flat().find(({ title }) => title === own.get("strip"));

  function draw() {
    const { clientWidth: width, clientHeight: height } = canvas;
    if (width < 40 || !run.end) return;
    const { tables } = window.hectorscope.plotted();
    const state = [width, height, run.begin, run.end, run.known, marks, tables.series?.known, own.get("strip"), own.get("theme"), own.get("present")].join();
    if (state === drawn) return;
    drawn = state;
    const [sharp, ctx, colour] = [window.devicePixelRatio || 1, canvas.getContext("2d"), own.style];
    Object.assign(canvas, { width: Math.round(width * sharp), height: Math.round(height * sharp) });
    ctx.setTransform(sharp, 0, 0, sharp, 0, 0);
    drawTrack(ctx, colour, width, tables.series);
    drawStrip(ctx, width, height, tables);
    for (const kind of Object.keys(SHAPES)) {
      for (const mark of marks) if (mark[1] === kind && mark[0] >= run.begin) drawMark(ctx, colour, width * share(mark[0]), kind);
    }
  }

  // How far the run is known, and how often the map was written.
  function drawTrack(ctx, colour, width, series) {
    ctx.fillStyle = colour("line");
    ctx.fillRect(0, LANES.track, width, 7);
    ctx.fillStyle = colour("muted");
    ctx.fillRect(0, LANES.track, width * share(run.known), 3);
    if (!series?.known) return;
    ctx.fillStyle = colour("accent");
    let last = 0;
    for (let row = 0; row < series.known; row += 1) {
      const updates = series.values[row * series.width + told.updates];
      if (updates > last && series.values[row * series.width] >= run.begin) ctx.fillRect(width * share(series.values[row * series.width]), LANES.track + 4, 0.6, 3);
      last = updates;
    }
  }

  function drawStrip(ctx, width, height, tables) {
    const chart = chosen();
    const table = chart && tables[chart.table];
    if (!table?.known) return;
    const whole = { ...table, count: table.known };
    charts.plot.strip(ctx, whole, chart, { width, top: LANES.strip, bottom: height - 1, stretch: [run.begin, run.end] }, chart.curves.map(window.hectorscope.plotted().colour));
  }

  function drawMark(ctx, colour, x, kind) {
    ctx.save();
    ctx.translate(x, LANES.marks);
    Object.assign(ctx, { fillStyle: colour(SHAPES[kind][0]), strokeStyle: colour("surface"), lineWidth: 1.5 });
    ctx.stroke(paths[kind]);
    ctx.fill(paths[kind]);
    ctx.restore();
  }

  // -------------------------------------------------------------------------------------------- pointing

  let dragging = false;

  function drag(event) {
    const seconds = timeAt(event);
    want(seconds);
    if (performance.now() - sent.at >= SENDING) seek(seconds);
  }

  track.addEventListener("pointerdown", (event) => {
    if (event.button) return;
    track.setPointerCapture(event.pointerId);
    dragging = true;
    seek(timeAt(event));
  });
  track.addEventListener("pointermove", (event) => {
    if (dragging) drag(event);
    hover(event);
  });
  // A time that was too soon behind another to be sent is sent once there is time for it.
  setInterval(() => dragging && wanted !== sent.value && performance.now() - sent.at >= SENDING && seek(wanted), SENDING);
  for (const over of ["pointerup", "pointercancel"]) track.addEventListener(over, () => {
    if (dragging && wanted !== sent.value) seek(wanted);
    dragging = false;
  });
  track.addEventListener("pointerleave", () => hover(null));
  track.addEventListener("keydown", (event) => {
    if (!(event.key in ARROWS) || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    seek(Math.min(Math.max((wanted ?? run.at) + ARROWS[event.key], run.begin), run.end ?? 0));
  });
  before.addEventListener("click", () => step(-1));
  next.addEventListener("click", () => step(1));

  // The time under the pointer, in every chart too; what the strip has there, and the marks.
  function hover(event) {
    const seconds = event && run.end ? timeAt(event) : null;
    window.hectorscope.plotted?.().point(seconds);
    tip.hidden = seconds === null;
    if (seconds === null) return;
    const box = track.getBoundingClientRect();
    const near = marks.filter(([time]) => Math.abs(share(time) - share(seconds)) * box.width <= NEAR).slice(0, 4);
    tip.replaceChildren(line("b", `${clock(seconds)}${seconds > run.known ? " · not known yet" : ""}`), ...values(seconds), ...near.map(([, kind, scan, text]) =>
      line("p", `${told.kinds[kind]}: ${text}${scan ? ` · scan ${scan}` : ""}`, kind)));
    tip.style.left = `${Math.min(Math.max(event.clientX, tip.offsetWidth / 2 + 8), innerWidth - tip.offsetWidth / 2 - 8)}px`;
    tip.style.bottom = `${innerHeight - box.top + 6}px`;
  }

  function line(name, text, kind) {
    const made = Object.assign(document.createElement(name), { textContent: text });
    if (kind) made.innerHTML = `<svg viewBox="-7 -7 14 14" style="fill:var(--hs-${SHAPES[kind][0]})"><path d="${SHAPES[kind][1]}"/></svg>`;
    if (kind) made.append(text);
    return made;
  }

  function values(seconds) {
    const chart = chosen();
    const table = chart && window.hectorscope.plotted().tables[chart.table];
    if (!table?.known || seconds > run.known) return [];
    const row = charts.rowAt({ ...table, count: table.known }, seconds);
    const each = chart.curves.map((curve) => `${chart.curves.length > 1 ? `${curve.name} ` : ""}${charts.shown(table.values[row * table.width + curve.column] * chart.factor)}`);
    return [line("span", `${chart.title}: ${each.join(", ")}`)];
  }

  // Where the pointer is in a chart; null: nowhere.
  function point(seconds) {
    cursor.hidden = seconds === null || !run.end;
    if (!cursor.hidden) cursor.style.left = `${100 * share(seconds)}%`;
  }

  // ------------------------------------------------------------------------------------------------ page

  // viser makes the element anew with each connection, and when it moves the panel.
  function mount() {
    const place = document.querySelector("[data-hs-timeline]");
    if (place && bar.parentElement !== place) {
      told = JSON.parse(place.dataset.hsTimeline);
      place.append(bar);
      drawn = "";
      answered();
      answered = window.hectorscope.ask(told.ask);
    }
    if (!choice.length && Object.keys(pages()).length) {
      choice.replaceChildren(...Object.entries(pages()).map(([name, list]) => {
        const group = Object.assign(document.createElement("optgroup"), { label: name });
        group.append(...list.map(({ title }) => new Option(title, title)));
        return group;
      }));
      choice.value = own.get("strip");
    }
    if (!document.hidden) draw();
  }
  setInterval(mount, TICK);
  setInterval(arrive, TICK);
  own.listen((name) => ["strip", "theme", "present"].includes(name) && requestAnimationFrame(draw));
  new ResizeObserver(() => requestAnimationFrame(draw)).observe(track);

  const timeline = { seek, step, point, state: () => ({ ...run, marks, wanted, dragging }) };
  Object.assign(window.hectorscope, { play, marks: (found) => ((marks = found), (drawn = "")), timeline });
})();
