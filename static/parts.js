// The parts of the page: viser's elements around ours are marked by what they hold, as words of data-hs-part, which the
// style sheets name. :has() would find the same elements without a script, but with it the browser goes through the
// style of the whole page whenever a figure changes.
"use strict";

(() => {
  const FLEX = ".mantine-Flex-root", PAPER = ".mantine-Paper-root";
  const FOLDER = `${PAPER} > ${PAPER} + div + div`; // the last element of each
  const present = (elements) => elements.filter(Boolean);
  const up = (steps) => (element) => {
    let at = element;
    for (let step = 0; step < steps; step++) at = at?.parentElement;
    return present([at]);
  };
  const next = (mark) => present([mark.parentElement?.nextElementSibling]);
  const around = (selector) => (element) => {
    const found = [];
    for (let at = element.parentElement?.closest(selector); at; at = at.parentElement?.closest(selector)) found.push(at);
    return found;
  };
  // The panel's header, which lies before what holds the bar at the top.
  const headers = (part) => [...part.parentElement.children].filter((each) => each.matches("[data-dock-unmergeable-header]"));
  // What lies beside a mark and holds something.
  const beside = (inside) => (mark) => [...(up(2)(mark)[0]?.children ?? [])].filter((each) => each.querySelector(inside));

  // [word, what is looked for, the elements that get the word for it]
  const PARTS = [
    ["mark", ".hs-mark", up(1)],
    ["bar", ".hs-bar", up(2)],
    ["bar-folder", ".hs-bar", up(5)],
    ["bar-frame", ".hs-bar", up(6)],
    ["status", ".hs-bar-status", up(2)],
    ["transport", ".hs-bar-transport", up(2)],
    ["timeline", ".hs-bar-timeline", up(2)],
    ["between-bars", ":is([data-dock-region], [data-hs-panel]) .hs-bar-status", () => present([document.getElementById("root")])],
    ["link", ".hs-bar-status", (mark) => around("[data-dock-unmergeable-header] ~ *")(mark).flatMap(headers)],
    ["live", ".hs-live", up(2)],
    ["run", ".hs-run", up(1)],
    ["tools", ".hs-tools", up(1)],
    ["losses", ".hs-losses", up(1)],
    ["clock", ".hs-bar", beside(".hs-clock")],
    ["track", ".hs-bar", beside(".hs-timeline")],
    ["choice", ".hs-bar", beside(".mantine-Select-root")],
    ["undo", ".hs-undo", next],
    ["with-timeline", ".hs-timeline", () => [document.documentElement]],
    ["over", ".hs-over", up(2)],
    ["over-folder", ".hs-over", up(5)],
    ["over-frame", ".hs-over", up(6)],
    ["over-line", ".hs-over", (mark) => up(2)(mark).filter((card) => card.querySelector(".hs-start-line, .hs-findings-line"))],
    ["buttons", ".hs-over", beside(".mantine-Button-root")],
    ["question", ".hs-question", around(".mantine-Modal-content")],
    ["answer", ".hs-asked", next],
    ["icon", "[role=tab] svg", (icon) => [...icon.closest("[role=tab]").children].filter((each) => each !== icon && each.contains(icon))],
    ["viser-settings", ".tabler-icon-adjustments", around(".mantine-ActionIcon-root")],
    ["folder", FOLDER, up(1)],
    ["name", `${FLEX} > div > p > label`, up(2)],
    ["named", `${FLEX} > div > p > label`, up(3)],
    ["slider", ".mantine-Slider-root", around(FLEX)],
    ["checkbox", ".mantine-Checkbox-root", around(FLEX)],
    ["log-slider", ".hs-log", next],
    ["log-number", ".hs-log", (mark) => next(mark).flatMap((slider) => present([slider.nextElementSibling]))],
  ];

  let marked = [];

  function mark() {
    const words = new Map();
    for (const [word, sought, find] of PARTS) {
      for (const element of document.querySelectorAll(sought)) {
        for (const part of find(element)) words.set(part, (words.get(part) ?? new Set()).add(word));
      }
    }
    for (const part of marked) if (!words.has(part)) part.removeAttribute("data-hs-part");
    for (const [part, given] of words) {
      const value = [...given].join(" ");
      if (part.getAttribute("data-hs-part") !== value) part.setAttribute("data-hs-part", value);
    }
    marked = [...words.keys()];
  }

  // A text that changes changes no part.
  const isElement = (node) => node.nodeType === Node.ELEMENT_NODE;
  const changed = ({ addedNodes, removedNodes }) => [...addedNodes, ...removedNodes].some(isElement);
  new MutationObserver((records) => records.some(changed) && mark()).observe(document.body, { childList: true, subtree: true });
  const add = (...more) => PARTS.push(...more);
  window.hectorscope = Object.assign(window.hectorscope ?? {}, { parts: { FOLDER, add, mark, next, up, around, beside } });
})();
