// Where this browser shows each level of the map (in a stack, side by side, or one alone), and the levels' names.
"use strict";

(() => {
  const { own, drawing } = window.hectorscope;
  const AISLE = 0.06; // of the map, between levels side by side
  const BOX = "/floor/focus/box"; // around what a camera should show, of size one before its scale
  const LEANING = 0.6; // how much a map loses of its height where the view is tilted
  const box = { x: 0, y: 0, width: 0, height: 0 };

  const page = () => window.__viserMutable;
  const place = (index) => page()?.nodeRefFromName?.[`/floor/map/level${index}`];

  function count() {
    let levels = 0;
    while (place(levels)) levels += 1;
    return levels;
  }

  // The part of the map that every level shows, metres on the floor.
  function measure() {
    const node = page().nodeRefFromName[BOX];
    const mesh = node?.children.find((child) => child.isMesh);
    if (!mesh) return false;
    Object.assign(box, { x: node.position.x, y: node.position.y, width: mesh.scale.x, height: mesh.scale.y });
    return true;
  }

  // As many columns as show the levels largest in this window.
  function columns(levels, top) {
    const { clientWidth, clientHeight } = page().canvas;
    const tall = clientHeight / (top ? 1 : LEANING);
    const share = (n) => {
      const rows = Math.ceil(levels / n);
      return Math.min(clientWidth / (n * (1 + AISLE) * box.width), tall / (rows * (1 + AISLE) * box.height));
    };
    return Array.from({ length: levels }, (_, i) => i + 1).reduce((best, n) => (share(n) > share(best) * 1.001 ? n : best), 1);
  }

  // Offset of each level from the robot's place on the floor, and whether it is to be seen.
  function places(levels, top) {
    const [layout, gap, level] = [own.get("layout"), own.get("gap"), own.get("level")];
    const all = Array.from({ length: levels }, (_, i) => i);
    if (layout === "one") return all.map((i) => ({ x: 0, y: 0, z: 0, shown: i === Math.min(level, levels - 1) }));
    if (layout === "stacked") return all.map((i) => ({ x: 0, y: 0, z: i * gap * Math.ceil(box.height), shown: i === 0 || !top }));
    const n = columns(levels, top);
    const [right, down] = [box.width, box.height].map((side) => side * (1 + AISLE));
    return all.map((i) => ({ x: (i % n) * right, y: -Math.floor(i / n) * down, z: 0, shown: true }));
  }

  // The compared run lies over the map, or beside it, on the side where no level ever is.
  const COMPARED = ["/floor/compared_map", "/compared"];
  function placeCompared(viser) {
    const node = viser.nodeRefFromName[`${COMPARED[0]}/cells`];
    const shown = own.get("beside") && node?.visible && own.layerShown("compared");
    const x = shown ? -box.width * (1 + AISLE) : 0;
    for (const name of COMPARED) move(viser, viser.nodeRefFromName[name], { x, y: 0, z: 0 });
    return shown ? [{ x, y: 0, z: 0, shown: true }] : [];
  }

  function move(viser, node, { x, y, z }) {
    if (!node || (node.position.x === x && node.position.y === y && node.position.z === z)) return;
    node.position.set(x, y, z);
    node.updateMatrixWorld(true);
    viser.requestRender?.();
  }

  // ------------------------------------------------------------------------------------------------ names

  const names = document.createElement("div");
  names.className = "hs-names";

  function resolutions() {
    const found = document.querySelector("[data-hs-levels]")?.dataset.hsLevels;
    return found ? JSON.parse(found) : [];
  }

  function label(index, at, camera) {
    const element = names.children[index] ?? names.appendChild(document.createElement("span"));
    const size = resolutions()[index];
    const text = `level ${index}${size ? ` · ${+(100 * size).toPrecision(4)} cm` : ""}`;
    if (element.textContent !== text) element.textContent = text;
    const point = camera.position.clone().set(box.x - box.width / 2 + at.x, box.y + box.height / 2 + at.y, at.z);
    point.applyMatrix4(page().nodeRefFromName["/floor"].matrixWorld).project(camera);
    const { width, height } = window.hectorscope.size;
    const [left, top] = [((point.x + 1) / 2) * width, ((1 - point.y) / 2) * height];
    const seen = at.shown && point.z < 1 && left > -40 && left < width && top > 0 && top < height + 20;
    element.style.transform = `translate(${Math.round(Math.max(4, left))}px, ${Math.round(Math.max(24, top))}px) translateY(-100%)`;
    element.hidden = !seen;
  }

  function labels(all, camera) {
    const home = page().canvas.parentElement;
    if (names.parentElement !== home) home.append(names);
    const shown = own.layerShown("names") && own.layerShown("map");
    if (names.hidden === shown) names.hidden = !shown;
    if (!shown) return;
    all.forEach((at, index) => label(index, at, camera));
    while (names.children.length > all.length) names.lastChild.remove();
  }

  let [laid, beside] = [[], []];
  drawing.push((viser, _scene, camera) => {
    const levels = count();
    if (!levels || !measure()) return;
    laid = places(levels, window.hectorscope.cameraState?.().top ?? false);
    laid.forEach((at, index) => {
      const node = place(index);
      node.visible = at.shown;
      move(viser, node, at);
    });
    beside = placeCompared(viser);
    labels(laid, camera);
  });

  window.hectorscope.levels = () => ({ box, places: laid, beside });
})();
