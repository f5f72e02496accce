// Measures a distance: after the key D, or the button, two clicks in the scene. Escape takes the line away.
"use strict";

(() => {
  const { pick } = window.hectorscope;
  const HINTS = ["Click two places to measure between them. Escape ends.", "Click the other place.", "Click for another distance. Escape ends."];
  const hint = Object.assign(document.createElement("p"), { className: "hs-measure-hint", hidden: true });
  hint.setAttribute("role", "status");
  let points = null; // [level, x, y], none or up to two; null while nothing is measured

  function drawn() {
    const ends = points.map((point) => pick.project(...point));
    if (ends.some((end) => !end)) return "";
    const dots = ends.map(([x, y]) => `<circle class="hs-mark-measure" cx="${x}" cy="${y}" r="4"/>`).join("");
    if (points.length < 2) return dots;
    const [[, ax, ay], [, bx, by]] = points;
    const [x, y] = [(ends[0][0] + ends[1][0]) / 2, (ends[0][1] + ends[1][1]) / 2 - 8];
    return `${pick.line("measure", points)}${dots}<text class="hs-mark-length" x="${x}" y="${y}">${Math.hypot(bx - ax, by - ay).toFixed(3)} m</text>`;
  }

  function set(next) {
    points = next;
    if (points === null) pick.release("measure");
    else pick.take("measure", clicked);
    pick.mark("measure", points?.length ? drawn : null);
    hint.hidden = points === null;
    hint.textContent = HINTS[points?.length ?? 0];
    const home = window.__viserMutable?.canvas?.parentElement;
    if (home && hint.parentElement !== home) home.append(hint);
  }

  function clicked({ clientX, clientY }) {
    const [place] = pick.places(clientX, clientY);
    if (place) set(points.length === 1 ? [...points, place] : [place]);
  }
  document.addEventListener("keydown", (event) => {
    if (event.key === "Escape" && points !== null) set(null);
  });

  Object.assign(window.hectorscope, { measure: { toggle: () => set(points === null ? [] : null), points: () => points } });
})();
