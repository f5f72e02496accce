// The plots of this browser: any charts, side by side below the scene or over the whole window, with one cursor over
// all of them and the timeline. The server sends rows of figures (panels/plots.py); a click on a chart goes there.
"use strict";

(() => {
  const { own } = window.hectorscope;
  const SHORTEST = 0.2; // seconds that a chart shows
  const PATIENCE = 100; // milliseconds between two drawings of new rows
  const LATEST = 1000; // milliseconds that a drawing may wait until the page has nothing else to do, as at its start
  const WINDOWS = { 10: "10 s", 30: "30 s", 120: "2 min", 1e9: "all" };
  const tables = {};
  let pages = null;
  let said = ""; // what they were read from
  let heard = null; // the element that the pages are read from
  let answered = () => {}; // ends the asking for rows
  let figures = [];
  let at = null; // seconds, where the cursor is
  let due = 0;
  let waits = false; // for a moment to draw in
  let shown = Infinity; // rows of what is shown: those behind it are known, but not yet to be drawn

  // ---------------------------------------------------------------------------------------------- rows

  // A table of rows of floats, the first of them the time. Rows from `first` on take the place of those there.
  function rows(name, first, base64) {
    const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
    const news = new Float32Array(bytes.buffer);
    const table = (tables[name] ??= { values: new Float32Array(4096), width: 0, count: 0, known: 0 });
    table.width = described()?.widths[name] ?? table.width;
    if (!table.width) return;
    answered();
    const begin = first * table.width;
    const end = begin + news.length;
    if (end > table.values.length) {
      const larger = new Float32Array(2 * end);
      larger.set(table.values.subarray(0, begin));
      table.values = larger;
    }
    table.values.set(news, begin);
    table.known = end / table.width;
    show(shown);
  }

  // The charts show so many rows of each table.
  function show(count) {
    shown = count;
    for (const table of Object.values(tables)) table.count = Math.min(table.known, count);
    due = Math.max(due, performance.now() + PATIENCE);
  }

  function described() {
    const mark = document.querySelector("[data-hs-charts]");
    if (mark && mark !== heard) {
      heard = mark;
      if (mark.dataset.hsCharts !== said) {
        said = mark.dataset.hsCharts;
        pages = JSON.parse(said);
        tabs.replaceChildren(); // and so built anew
      }
      // Now the page can take rows. With each connection the mark is a new one, and what was sent may be lost.
      answered();
      answered = window.hectorscope.ask(mark.dataset.hsAsk);
    }
    return pages;
  }

  // ----------------------------------------------------------------------------------------------- page

  const area = document.createElement("section");
  area.className = "hs-plots";
  area.setAttribute("aria-label", "Plots");
  area.innerHTML = `<div class="hs-grip" title="Drag to change the height"></div><header><div class="hs-pages"></div>
    <select data-hs-own="window" aria-label="Window" title="How much of the past is shown">${Object.entries(WINDOWS)
      .map(([value, name]) => `<option value="${value}">${name}</option>`).join("")}</select>
    <button type="button" class="hs-tool" data-hs-own="plots" data-hs-value='"full"' title="Plots over the whole window" aria-label="Plots over the whole window">
      <svg viewBox="0 0 24 24"><path d="M4 9V4h5M20 9V4h-5M4 15v5h5M20 15v5h-5"/></svg></button>
    <button type="button" class="hs-tool hs-close" title="No plots · G" aria-label="No plots"><svg viewBox="0 0 24 24"><path d="M6 6l12 12M18 6 6 18"/></svg></button>
    </header><div class="hs-charts"></div><p class="hs-empty">No data yet.</p>`;
  const [tabs, charts, nothing] = [".hs-pages", ".hs-charts", ".hs-empty"].map((part) => area.querySelector(part));
  area.querySelector(".hs-close").addEventListener("click", () => own.set("plots", "off"));
  document.body.append(area);

  function choosePage(name) {
    const chosen = own.get("pages");
    own.set("pages", chosen.includes(name) ? chosen.filter((page) => page !== name) : [...chosen, name]);
  }

  function build() {
    const names = Object.keys(described()?.pages ?? {});
    tabs.replaceChildren(...names.map((name) => {
      const tab = Object.assign(document.createElement("button"), { type: "button", textContent: name });
      tab.setAttribute("aria-pressed", String(own.get("pages").includes(name)));
      tab.addEventListener("click", () => choosePage(name));
      return tab;
    }));
    const wanted = names.filter((name) => own.get("pages").includes(name));
    figures = wanted.flatMap((name) => pages.pages[name]).map(figure);
    charts.replaceChildren(...figures.map(({ element }) => element));
    drawLater();
  }

  function figure(chart) {
    const element = Object.assign(document.createElement("figure"), { hidden: true }); // until it is drawn
    element.innerHTML = `<figcaption><b></b></figcaption><div class="hs-canvas"><canvas role="img"></canvas><i class="hs-cursor" hidden></i></div>`;
    element.querySelector("b").textContent = chart.title;
    element.querySelector("figcaption").classList.toggle("hs-several", chart.curves.length > 1);
    const values = chart.curves.map((curve) => {
      const entry = Object.assign(document.createElement("button"), { type: "button", className: "hs-entry", title: "Show or hide" });
      entry.addEventListener("click", () => toggleCurve(chart, curve));
      const dot = Object.assign(document.createElement("i"), { className: "hs-dot" });
      dot.style.background = colour(curve);
      const value = document.createElement("output");
      entry.append(dot, Object.assign(document.createElement("small"), { className: "hs-label", textContent: curve.name }), value);
      element.querySelector("figcaption").append(entry);
      return { entry, dot, value };
    });
    const canvas = element.querySelector("canvas");
    canvas.setAttribute("aria-label", chart.title);
    const made = { chart, element, canvas, values, cursor: element.querySelector(".hs-cursor"), shape: null };
    canvas.addEventListener("pointermove", (event) => point(timeAt(made, event)));
    canvas.addEventListener("pointerleave", () => point(null));
    canvas.addEventListener("wheel", (event) => magnify(timeAt(made, event), event), { passive: false });
    canvas.addEventListener("click", (event) => window.hectorscope.timeline?.seek(timeAt(made, event)));
    return made;
  }

  // Curves that this browser does not show, by chart and name.
  const nameOf = (chart, curve) => `${chart.title}/${curve.name}`;
  const isShown = (chart, curve) => !own.get("curves").includes(nameOf(chart, curve));
  function toggleCurve(chart, curve) {
    const [name, hidden] = [nameOf(chart, curve), own.get("curves")];
    own.set("curves", hidden.includes(name) ? hidden.filter((each) => each !== name) : [...hidden, name]);
  }

  function colour({ colour: name }) {
    if (typeof name !== "number") return own.style(name);
    const series = own.style("series").split(/\s+/);
    return series[name % series.length];
  }

  // ----------------------------------------------------------------------------------------------- time

  // All charts show the same stretch of time: up to the newest row.
  function span() {
    const { values, width, count } = tables.series ?? { count: 0 };
    if (count < 2) return null;
    if (zoom) return zoom;
    const end = values[(count - 1) * width];
    const begin = Math.max(values[0], end - own.get("window"));
    return end > begin ? [begin, end] : null;
  }

  // The wheel magnifies the time under the pointer, in all charts together; turned back it leads to the window again.
  let zoom = null;
  function magnify(seconds, event) {
    const stretch = span();
    if (seconds === null || !stretch) return;
    event.preventDefault();
    const { values, width, count } = tables.series;
    const [share, first, last] = [Math.exp(event.deltaY / 500), values[0], values[(count - 1) * width]];
    const [begin, end] = stretch.map((edge) => seconds + share * (edge - seconds));
    zoom = end - begin >= own.get("window") || (begin <= first && end >= last) ? null : end - begin < SHORTEST ? zoom : [Math.max(begin, first), Math.min(end, last)];
    requestAnimationFrame(draw);
    point(seconds);
  }

  function timeAt({ shape }, event) {
    const stretch = span();
    if (!shape || !stretch) return null;
    const share = (event.offsetX - shape.left) / (shape.right - shape.left);
    return stretch[0] + Math.min(Math.max(share, 0), 1) * (stretch[1] - stretch[0]);
  }

  // The cursor stands at a time in every chart and on the timeline; null takes it away.
  function point(seconds) {
    at = seconds;
    charts.classList.toggle("hs-pointing", seconds !== null);
    window.hectorscope.timeline?.point(seconds);
    figures.forEach(read);
  }

  document.addEventListener("pointermove", ({ target }) => {
    if (at !== null && !target.closest?.(".hs-canvas, .hs-timeline-track")) point(null);
  });

  // ---------------------------------------------------------------------------------------------- charts

  const { rowAt, plot, shown: worded } = window.hectorscope.charts;

  // The figures at the cursor, or the newest ones.
  function read({ chart, cursor, values, shape }) {
    const [table, stretch] = [tables[chart.table], span()];
    const inside = at !== null && stretch && shape && stretch[0] <= at && at <= stretch[1];
    cursor.hidden = !inside;
    if (inside) cursor.style.left = `${shape.left + ((at - stretch[0]) / (stretch[1] - stretch[0])) * (shape.right - shape.left)}px`;
    const row = !table?.count ? -1 : inside ? rowAt(table, at) : table.count - 1;
    chart.curves.forEach((curve, i) => {
      const value = row < 0 ? NaN : table.values[row * table.width + curve.column] * chart.factor;
      const text = worded(value);
      if (values[i].value.textContent !== text) values[i].value.textContent = text;
    });
  }

  function draw() {
    const stretch = span();
    let any = false;
    for (const made of figures) {
      const there = !!stretch && !!tables[made.chart.table] && plot.any(tables[made.chart.table], made.chart, stretch);
      made.element.hidden = !there;
      any ||= there;
    }
    nothing.hidden = any;
    const there = new Set(figures.filter(({ element }) => !element.hidden).map(({ chart }) => chart));
    for (const tab of tabs.children) tab.classList.toggle("hs-bare", !pages.pages[tab.textContent].some((chart) => there.has(chart)));
    if (own.get("plots") === "off" || !stretch) return;
    const visible = figures.filter(({ element }) => !element.hidden);
    const sizes = visible.map(({ canvas }) => plot.size(canvas));
    visible.forEach((made, at) => {
      made.chart.curves.forEach((curve, i) => {
        made.values[i].dot.style.background = colour(curve);
        made.values[i].entry.setAttribute("aria-pressed", String(isShown(made.chart, curve)));
      });
      const curves = made.chart.curves.filter((curve) => isShown(made.chart, curve));
      made.shape = plot.draw(made.canvas, sizes[at], tables[made.chart.table], { ...made.chart, curves }, stretch, curves.map(colour));
    });
    visible.forEach(read);
  }

  function drawLater() {
    if (!waits) requestIdleCallback(() => (waits = false) || draw(), { timeout: LATEST });
    waits = true;
  }

  // New rows are drawn some times a second, and not while nobody sees them.
  setInterval(() => {
    if (described() && !tabs.childElementCount) build();
    if (!due || performance.now() < due || document.hidden) return;
    due = 0;
    drawLater();
  }, PATIENCE);
  own.listen((name) => {
    if (name === "window") zoom = null;
    if (name === "pages") build();
    else if (["curves", "window", "theme", "plots", "height", "present"].includes(name)) requestAnimationFrame(draw);
  });
  new ResizeObserver(drawLater).observe(charts);

  const grip = area.querySelector(".hs-grip");
  grip.addEventListener("pointerdown", (event) => {
    grip.setPointerCapture(event.pointerId);
    const [from, height] = [event.clientY, own.get("height")];
    grip.onpointermove = ({ clientY }) => own.set("height", Math.min(Math.max(height + from - clientY, 120), innerHeight - 240));
  });
  grip.addEventListener("pointerup", () => (grip.onpointermove = null));

  Object.assign(window.hectorscope, { rows, plotted: () => ({ span: span(), at, tables, pages: pages?.pages, colour, point, show }) });
})();
