// What each browser keeps for itself: theme, layout, layers, plots, camera. It stays in the browser's own storage;
// the server and other browsers hear nothing of it. Elements with data-hs-own="key" show and change a choice:
// lists, sliders and boxes by their value, buttons by data-hs-value (without one a button is a switch).
"use strict";

(() => {
  const KEY = "hectorscope";
  const CHOICES = {
    theme: ["dark", "light"],
    layout: ["stacked", "side", "one"],
    plots: ["below", "full", "off"],
    sheet: ["half", "full", "low"],
  };
  const DEFAULTS = {
    theme: "dark", layout: "stacked", gap: 0.5, level: 0, layers: {}, present: false, beside: false, panels: true,
    plots: innerWidth < 900 ? "off" : "below", pages: ["Covariance", "Error against truth"], curves: [], window: 30, height: 220, strip: "Mean residual",
    sheet: "half", camera: null, sound: false,
  };
  const RANGES = { gap: [0.05, 2], level: [0, 31], window: [1, 1e9], height: [120, 2000] };
  const OWN = "[data-hs-own]";
  const root = document.documentElement;
  const heard = [];

  // What is stored may be of another version, or of anybody's making: what does not fit is left out.
  function fits(key, value) {
    const model = DEFAULTS[key];
    if (CHOICES[key]) return CHOICES[key].includes(value);
    if (RANGES[key]) return Number.isFinite(value) && RANGES[key][0] <= value && value <= RANGES[key][1];
    if (key === "camera") return value === null || Array.isArray(value?.pose) && value.pose.length === 6 && value.pose.every(Number.isFinite);
    if (key === "pages" || key === "curves") return Array.isArray(value) && value.every((page) => typeof page === "string");
    return typeof value === typeof model && value !== null;
  }

  function stored() {
    try {
      const found = Object.entries(JSON.parse(localStorage.getItem(KEY)) ?? {});
      return Object.fromEntries(found.filter(([key, value]) => key in DEFAULTS && fits(key, value)));
    } catch {
      return {};
    }
  }

  const chosen = { ...DEFAULTS, ...stored() };
  const get = (key) => chosen[key];

  function set(key, value) {
    if (!(key in DEFAULTS) || !fits(key, value)) return;
    chosen[key] = value;
    try {
      localStorage.setItem(KEY, JSON.stringify(chosen));
    } catch {
      // Without storage a choice lasts as long as the page.
    }
    apply(key);
    document.querySelectorAll(OWN).forEach(show);
    window.__viserMutable?.requestRender?.();
  }

  // A value of the style sheet as it is in this browser. It is read once, as each reading styles the whole page anew.
  let styles = {};
  const style = (name) => (styles[name] ||= getComputedStyle(root).getPropertyValue(`--hs-${name}`).trim());

  function apply(key) {
    styles = {};
    if (["plots", "sheet", "present", "panels"].includes(key)) root.dataset[`hs${key[0].toUpperCase()}${key.slice(1)}`] = chosen[key];
    if (key === "height") root.style.setProperty("--hs-plots-height", `${chosen.height}px`);
    if (key === "theme" && root.dataset.mantineColorScheme !== chosen.theme) root.dataset.mantineColorScheme = chosen.theme;
    heard.forEach((listen) => listen(key, chosen[key]));
  }

  // ------------------------------------------------------------------------------------------- controls

  const wanted = ({ dataset }) => (dataset.hsValue === undefined ? undefined : JSON.parse(dataset.hsValue));
  const isOn = (at) => layer(at) ? layerShown(layer(at)) : at.dataset.hsInverse !== undefined ? !matches(at) : matches(at);
  const matches = (at) => (wanted(at) === undefined ? chosen[at.dataset.hsOwn] === true : chosen[at.dataset.hsOwn] === wanted(at));

  function show(at) {
    const value = chosen[at.dataset.hsOwn];
    if (at.tagName === "BUTTON") at.setAttribute("aria-pressed", String(isOn(at)));
    else if (at.type === "checkbox") at.checked = layer(at) ? layerShown(layer(at)) : value;
    else if (at !== document.activeElement || at.tagName === "SELECT") at.value = String(value);
  }

  // The layers of the scene as the server describes them: nodes, whether a new browser shows them, how to ask for them.
  let described = {};
  function layers() {
    const found = document.querySelector("[data-hs-layers]")?.dataset.hsLayers;
    if (found && found !== described.text) described = { text: found, layers: JSON.parse(found) };
    return described.layers ?? {};
  }
  const layer = (at) => at.dataset.hsLayer;
  const layerShown = (name) => chosen.layers[name] ?? layers()[name]?.shown ?? true;

  function changed({ target }) {
    if (!target.matches?.(OWN) || target.tagName === "BUTTON") return;
    if (layer(target)) set("layers", { ...chosen.layers, [layer(target)]: target.checked });
    else if (target.type === "checkbox") set(target.dataset.hsOwn, target.checked);
    else set(target.dataset.hsOwn, typeof DEFAULTS[target.dataset.hsOwn] === "number" ? Number(target.value) : target.value);
  }

  // A button whose value is the present one goes back: from the light theme to the dark one, from full to below.
  const BACK = { theme: "dark", plots: "below", sheet: "half" };
  function clicked({ target }) {
    const at = target.closest?.(`button${OWN}`);
    if (!at) return;
    const value = wanted(at);
    if (layer(at)) set("layers", { ...chosen.layers, [layer(at)]: !layerShown(layer(at)) });
    else if (value === undefined) set(at.dataset.hsOwn, !chosen[at.dataset.hsOwn]);
    else set(at.dataset.hsOwn, matches(at) ? BACK[at.dataset.hsOwn] ?? value : value);
  }

  document.addEventListener("input", changed);
  document.addEventListener("click", clicked);
  // The page draws its panels by itself, at any time: what is new there shows what is chosen.
  new MutationObserver((records) => {
    if (records.some((record) => record.addedNodes.length)) document.querySelectorAll(OWN).forEach(show);
  }).observe(document.body, { childList: true, subtree: true });
  new MutationObserver(() => apply("theme")).observe(root, { attributeFilter: ["data-mantine-color-scheme"] });
  Object.keys(DEFAULTS).forEach(apply);

  // -------------------------------------------------------------------------------------------- elements

  function element(tag, values = {}, ...inside) {
    const made = Object.assign(document.createElement(tag), values);
    made.append(...inside);
    return made;
  }

  // --------------------------------------------------------------------------------------------- drawing

  // Functions that are called before each drawing of the scene, once what the server sent is in it.
  const drawing = [];
  const pages = () => window.__viserMutable;
  function hook() {
    const scene = pages()?.scene;
    if (scene && scene.onBeforeRender !== before) scene.onBeforeRender = before;
  }
  // Pixels of the scene on the page, also while a larger picture of it is drawn (picture.js). To ask the page instead
  // costs a layout of it in every drawing.
  const size = {
    width: 0,
    height: 0,
    set(...pixels) {
      [size.width, size.height] = pixels.map((each) => each / (window.hectorscope.enlarged ?? 1));
    },
  };
  function before(renderer, scene, camera) {
    renderer.getSize(size);
    for (const draw of drawing) draw(pages(), scene, camera, renderer);
  }
  document.addEventListener("DOMContentLoaded", () => setInterval(hook, 200)); // every script of ours is there then

  const own = { get, set, toggle: (key) => set(key, !chosen[key]), listen: (call) => heard.push(call), style, layers, layerShown };
  window.hectorscope = Object.assign(window.hectorscope ?? {}, { own, drawing, element, size });
})();
