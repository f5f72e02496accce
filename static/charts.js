// Drawing of one chart: curves over time, with axes. Every pixel shows the lowest and highest value of its time.
"use strict";

(() => {
  const LEFT = 44; // pixels of the value axis
  const BOTTOM = 17; // and of the time axis
  const TOP = 6;
  const RIGHT = 8;
  const LINES = 4; // about, of the value axis
  const FLOOR = 1e-4; // of a value on an axis of decades: zero has no logarithm

  const style = (name) => window.hectorscope.own.style(name);

  // The last row at or before a time.
  function rowAt({ values, width, count }, time) {
    let [low, high] = [0, count];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (values[middle * width] <= time) low = middle + 1;
      else high = middle;
    }
    return Math.max(low - 1, 0);
  }

  const shown = (value) => (!Number.isFinite(value) ? "–" : Math.abs(value) >= 100 ? String(Math.round(value)) : `${+value.toPrecision(3)}`);

  // Of each curve: (first, lowest, highest, last) for each pixel that has a value, in the chart's unit; angles go on
  // beyond half a turn. A plain loop, as an hour has millions of values.
  function thinned(table, chart, [begin, end], pixels) {
    const { values, width, count } = table;
    const [first, share, { angles, factor, log }] = [rowAt(table, begin), pixels / (end - begin), chart];
    return chart.curves.map(({ column }) => {
      const columns = new Map();
      let [turns, last, there, x] = [0, NaN, null, -1];
      for (let row = angles ? 0 : first; row < count; row += 1) {
        let value = values[row * width + column];
        if (!Number.isFinite(value)) continue;
        if (angles) {
          if (Number.isFinite(last)) turns -= Math.round((value - last) / (2 * Math.PI));
          last = value;
          if (row < first) continue;
          value += 2 * Math.PI * turns;
        }
        value *= factor;
        if (log) value = Math.log10(Math.max(value, FLOOR));
        const at = Math.round(Math.max(values[row * width] - begin, 0) * share);
        if (at !== x) {
          columns.set((x = at), (there = [value, value, value, value]));
          continue;
        }
        if (value < there[1]) there[1] = value;
        if (value > there[2]) there[2] = value;
        there[3] = value;
      }
      return columns;
    });
  }

  function any(table, chart, [begin]) {
    const first = rowAt(table, begin);
    return chart.curves.some(({ column }) => {
      let found = 0;
      for (let row = first; row < table.count && found < 2; row += 1) found += Number.isFinite(table.values[row * table.width + column]);
      return found > 1;
    });
  }

  function range(curves, log) {
    let [low, high] = [Infinity, -Infinity];
    for (const columns of curves) {
      for (const [, least, most] of columns.values()) [low, high] = [Math.min(low, least), Math.max(high, most)];
    }
    if (!(high >= low)) return [0, 1];
    if (log) return [Math.floor(low), Math.max(Math.ceil(high), Math.floor(low) + 1)];
    const room = high > low ? 0.08 * (high - low) : 0.05 * Math.abs(high) || 1;
    return [low - room, high + room];
  }

  function step(span, most) {
    const rough = span / most;
    const decade = 10 ** Math.floor(Math.log10(rough));
    return decade * [1, 2, 5, 10].find((times) => times * decade >= rough);
  }

  function ticks([low, high], most) {
    const each = step(high - low, most);
    const found = [];
    for (let i = Math.ceil(low / each - 1e-9); i * each <= high + 1e-9 * each; i += 1) found.push(+(i * each).toPrecision(12));
    return found;
  }

  const clock = (seconds) => (seconds < 60 ? `${+seconds.toFixed(2)} s` : `${Math.floor(seconds / 60)}:${String(+(seconds % 60).toFixed(1)).padStart(2, "0")}`);
  const decade = (power) => (power >= -2 && power <= 4 ? `${+(10 ** power).toPrecision(1)}` : `1e${power}`);

  function axes(ctx, chart, spans, frame) {
    const { left, right, top, bottom, scale } = frame;
    const [x, y] = spans;
    ctx.font = `${11 * scale}px ${style("font")}`;
    ctx.lineWidth = 1;
    ctx.strokeStyle = style("line");
    ctx.fillStyle = style("muted");
    const rule = (...at) => {
      ctx.beginPath();
      ctx.moveTo(at[0], at[1]);
      ctx.lineTo(at[2], at[3]);
      ctx.stroke();
    };
    const levels = chart.log ? ticks(y, LINES).filter(Number.isInteger) : ticks(y, Math.max(2, Math.min(LINES, (bottom - top) / (20 * scale))));
    ctx.textAlign = "right";
    ctx.textBaseline = "middle";
    for (const value of levels) {
      const at = Math.round(frame.y(value)) + 0.5;
      rule(left, at, right, at);
      ctx.fillText(chart.log ? decade(value) : `${+value.toPrecision(6)}`, left - 5, at);
    }
    ctx.textAlign = "center";
    ctx.textBaseline = "top";
    for (const value of ticks(x, Math.max(2, (right - left) / (48 * scale)))) {
      const at = Math.round(frame.x(value)) + 0.5;
      rule(at, top, at, bottom);
      const half = ctx.measureText(clock(value)).width / 2;
      if (at - half >= left - 20 && at + half <= right + RIGHT) ctx.fillText(clock(value), at, bottom + 4);
    }
  }

  function curve(ctx, columns, frame) {
    ctx.beginPath();
    let before = null;
    for (const [x, [first, low, high, last]] of columns) {
      const at = frame.left + x;
      if (before === null) ctx.moveTo(at, frame.y(first));
      else ctx.lineTo(at, frame.y(first));
      if (high > low) [low, high, last].forEach((value) => ctx.lineTo(at, frame.y(value)));
      before = x;
    }
    ctx.stroke();
  }

  const size = ({ clientWidth: width, clientHeight: height }) => ({ width, height });

  // Draws the stretch [begin, end] of a table; gives the chart's edges in pixels of the page, null without room.
  // The size of the canvas is asked for before anything is drawn: else the page is laid out anew for each chart.
  function draw(canvas, { width, height }, table, chart, stretch, colours) {
    if (width < 80 || height < 40) return null;
    const scale = Number(style("scale")) || 1;
    const [sharp, ctx] = [window.devicePixelRatio || 1, canvas.getContext("2d")];
    Object.assign(canvas, { width: Math.round(width * sharp), height: Math.round(height * sharp) });
    ctx.setTransform(sharp, 0, 0, sharp, 0, 0);
    const [left, right, top, bottom] = [LEFT * scale, width - RIGHT, TOP, height - BOTTOM * scale];
    const curves = thinned(table, chart, stretch, right - left);
    const levels = range(curves, chart.log);
    const frame = {
      left, right, top, bottom, scale,
      x: (time) => left + ((time - stretch[0]) / (stretch[1] - stretch[0])) * (right - left),
      y: (value) => bottom - ((value - levels[0]) / (levels[1] - levels[0])) * (bottom - top),
    };
    axes(ctx, chart, [stretch, levels], frame);
    Object.assign(ctx, { lineWidth: 1.6 * scale, lineJoin: "round" });
    curves.forEach((columns, i) => {
      ctx.strokeStyle = colours[i];
      curve(ctx, columns, frame);
    });
    return { left, right };
  }

  // A stretch of a table without axes, between two heights.
  function strip(ctx, table, chart, { width, top, bottom, stretch }, colours) {
    const curves = thinned(table, chart, stretch, width);
    const levels = range(curves, chart.log);
    const frame = { left: 0, y: (value) => bottom - ((value - levels[0]) / (levels[1] - levels[0])) * (bottom - top) };
    Object.assign(ctx, { lineWidth: 1, lineJoin: "round" });
    curves.forEach((columns, i) => {
      ctx.strokeStyle = colours[i];
      curve(ctx, columns, frame);
    });
  }

  window.hectorscope = Object.assign(window.hectorscope ?? {}, { charts: { rowAt, shown, ticks, plot: { any, draw, strip, size } } });
})();
