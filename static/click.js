// Where a person points in the scene: a click that is no drag, in metres of the map on every level that it meets.
"use strict";

(() => {
  const STILL = 5; // pixels
  const AIM = 9; // pixels around a click in which a beam is meant

  const page = () => window.__viserMutable;
  const floor = () => page()?.nodeRefFromName?.["/floor"];

  // Where the sight through a point of the window meets each shown level, nearest first: [level, x, y].
  function places(left, top) {
    const [{ camera, canvas }, ground] = [page() ?? {}, floor()];
    if (!camera || !ground) return [];
    const box = canvas.getBoundingClientRect();
    const [x, y] = [(2 * (left - box.left)) / box.width - 1, 1 - (2 * (top - box.top)) / box.height];
    const [near, far] = [-1, 0.9].map((z) => ground.worldToLocal(camera.position.clone().set(x, y, z).unproject(camera)));
    const levels = window.hectorscope.levels();
    const met = levels.places.flatMap((at, level) => {
      const way = (at.z - near.z) / (far.z - near.z);
      if (!at.shown || !(way > 0)) return [];
      return [{ way, level, x: near.x + way * (far.x - near.x) - at.x, y: near.y + way * (far.y - near.y) - at.y }];
    });
    const inside = met.filter((at) => Math.abs(at.x - levels.box.x) <= levels.box.width / 2 && Math.abs(at.y - levels.box.y) <= levels.box.height / 2);
    return (inside.length ? inside : met.slice(0, 1)).sort((a, b) => a.way - b.way).map((at) => [at.level, at.x, at.y]);
  }

  // Metres on the map that some pixels around a point of the window cover.
  function reach(left, top) {
    const [[here], [beside]] = [places(left, top), places(left + AIM, top)];
    return here && beside && here[0] === beside[0] ? Math.hypot(here[1] - beside[1], here[2] - beside[2]) : 0;
  }

  // A place on a level in pixels of the scene; null behind the camera.
  function project(level, x, y) {
    const [{ camera }, { size, levels }] = [page() ?? {}, window.hectorscope];
    const at = levels().places[level];
    if (!camera || !at || !floor()) return null;
    const point = camera.position.clone().set(x + at.x, y + at.y, at.z).applyMatrix4(floor().matrixWorld).project(camera);
    return point.z < 1 ? [((point.x + 1) / 2) * size.width, ((1 - point.y) / 2) * size.height] : null;
  }

  // A click goes to whoever took clicks last, and has not given them back; to those who listen if nobody has.
  const heard = [];
  const takers = new Map(); // by name, in the order of taking
  function take(name, call) {
    takers.set(name, call);
    document.documentElement.classList.add("hs-aiming");
  }
  function release(name) {
    takers.delete(name);
    document.documentElement.classList.toggle("hs-aiming", takers.size > 0);
  }

  let from = null;
  document.addEventListener("pointerdown", (event) => {
    from = event.target === page()?.canvas && event.button === 0 ? [event.clientX, event.clientY] : null;
  }, true);
  document.addEventListener("pointerup", (event) => {
    const still = from && Math.hypot(event.clientX - from[0], event.clientY - from[1]) <= STILL;
    from = null;
    if (still) (takers.size ? [...takers.values()].slice(-1) : heard).forEach((call) => call(event));
  }, true);

  // Marks over the scene, drawn anew with each picture of it.
  const marks = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  marks.classList.add("hs-marks");
  const shapes = new Map();
  function mark(name, shape) {
    if (shape) shapes.set(name, shape);
    else shapes.delete(name);
    page()?.requestRender?.();
  }
  function line(kind, points) {
    const at = points.map((point) => project(...point));
    return at.some((point) => !point) ? "" : `<polygon class="hs-mark-${kind}" points="${at.map(([x, y]) => `${x.toFixed(1)},${y.toFixed(1)}`).join(" ")}"/>`;
  }
  window.hectorscope.drawing.push(() => {
    const home = page().canvas?.parentElement;
    if (home && marks.parentElement !== home) home.append(marks);
    const drawn = [...shapes.values()].map((shape) => shape()).join("");
    if (marks.innerHTML !== drawn) marks.innerHTML = drawn;
  });

  Object.assign(window.hectorscope, { pick: { places, reach, project, mark, line, take, release, listen: (call) => heard.push(call) } });
})();
