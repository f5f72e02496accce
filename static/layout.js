// The page's own layout: full screen, the sheet of small screens, keys of this browser, and their list.
"use strict";

(() => {
  const { own } = window.hectorscope;
  const KEYS = [
    ["Run, shared by every browser", [["space", "play or pause"], [".", "step one scan"], [",", "back one scan"], ["N", "next mark of the timeline"], ["Shift N", "mark before"], ["R", "restart"], ["L", "back to now, of a stream"], ["U", "undo, for a minute"], ["[ and ]", "slower, faster"]]],
    ["Camera", [["1", "top"], ["2", "follow the robot"], ["3", "free"], ["4", "whole map"]]],
    ["This browser", [["G", "plots: below the scene or none"], ["X", "plots over the whole window"], ["H", "panels"], ["D", "measure a distance: two clicks"], ["B", "look closer at the beam ahead; a click looks at a beam or a cell"], ["Esc", "close it"], ["I", "look inside the matcher, while the run is paused"], ["T", "light or dark theme"], ["P", "presentation: large type"], ["F", "full screen"], ["O", "open a recording"], ["E", "lessons"], ["C", "copy a link to this view"], ["?", "these keys"], ["Ctrl K", "find any command"]]],
  ];

  const screen = () => (document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen?.());
  const swap = (key, one, other) => own.set(key, own.get(key) === one ? other : one);
  const recordings = () => window.hectorscope.recordings?.();
  const link = () => window.hectorscope.link?.();
  const ACTS = {
    g: () => swap("plots", "off", "below"),
    x: () => swap("plots", "full", "below"),
    h: () => own.toggle("panels"),
    t: () => swap("theme", "light", "dark"),
    p: () => own.toggle("present"),
    f: screen,
    o: recordings,
    e: () => window.hectorscope.lessons?.toggle(),
    c: link,
    d: () => window.hectorscope.measure.toggle(),
    b: () => window.hectorscope.closer.ahead(),
    i: () => window.hectorscope.xray.toggle(),
    n: ({ shiftKey }) => window.hectorscope.timeline?.step(shiftKey ? -1 : 1),
    "?": keys,
  };
  const DO = { lessons: () => window.hectorscope.lessons?.toggle(), screen, keys, recordings, link, picture: () => window.hectorscope.picture?.(), export: () => window.hectorscope.exporting.ask(), note: () => window.hectorscope.exporting.pin(), video: () => window.hectorscope.exporting.video(), measure: () => window.hectorscope.measure.toggle(), xray: () => window.hectorscope.xray.toggle() };

  // ----------------------------------------------------------------------------------------------- keys

  const overlay = document.createElement("dialog");
  overlay.className = "hs-keys";
  overlay.setAttribute("aria-label", "Keys");
  overlay.innerHTML = `<h2>Keys</h2><div>${KEYS.map(([title, list]) => `<section><h3>${title}</h3><dl>${list
    .map(([key, what]) => `<dt>${key.split(" and ").map((each) => `<kbd>${each}</kbd>`).join(" ")}</dt><dd>${what}</dd>`)
    .join("")}</dl></section>`).join("")}</div>`;
  overlay.addEventListener("click", () => overlay.close());
  document.body.append(overlay);

  function keys() {
    if (overlay.open) overlay.close();
    else overlay.showModal();
  }

  const typing = (at) => at?.matches?.("input:not([type=checkbox], [type=range]), textarea, select, [contenteditable]");
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.repeat || typing(event.target)) return;
    const act = ACTS[event.key.toLowerCase()];
    if (!act || (overlay.open && event.key !== "?")) return;
    event.preventDefault();
    act(event);
  });
  document.addEventListener("click", ({ target }) => DO[target.closest?.("[data-hs-do]")?.dataset.hsDo]?.());

  // ---------------------------------------------------------------------------------------------- sheet

  // viser shows its panel in another way on a phone; marked, it gets the same style as the docked one.
  const handle = Object.assign(document.createElement("button"), { type: "button", className: "hs-handle", title: "Panels: drag, or click to fold" });
  handle.setAttribute("aria-label", "Panels");
  
  const STATES = ["low", "half", "full"];
  let from = null;
  handle.addEventListener("pointerdown", (event) => {
    handle.setPointerCapture(event.pointerId);
    from = event.clientY;
  });
  handle.addEventListener("pointerup", (event) => {
    const moved = from === null ? 0 : from - event.clientY;
    from = null;
    const now = STATES.indexOf(own.get("sheet"));
    if (Math.abs(moved) > 30) own.set("sheet", STATES[Math.min(Math.max(now + Math.sign(moved), 0), 2)]);
    else own.set("sheet", now === 0 ? "half" : "low");
  });
  handle.addEventListener("keydown", (event) => event.key === "Enter" && own.set("sheet", own.get("sheet") === "low" ? "half" : "low"));

  const mark = () => {
    const phone = document.querySelector("#root .mantine-Paper-root:has(.hs-bar-status):not([data-dock-root] *):not(.mantine-Paper-root .mantine-Paper-root)");
    const root = document.getElementById("root");
    if (root?.childElementCount && handle.parentElement !== root) root.append(handle); // what was there before it is cleared away
    if (phone && !phone.hasAttribute("data-hs-panel")) phone.setAttribute("data-hs-panel", "");
  };
  new MutationObserver(mark).observe(document.getElementById("root") ?? document.body, { childList: true, subtree: true });
  mark();
})();
