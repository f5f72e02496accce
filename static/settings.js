// The settings: each browser finds them by words, and shows those of experts or not. A button resets one of them.
"use strict";

(() => {
  const SETTING = ".hs-setting";
  const { parts } = window.hectorscope;
  let shown = "";

  // A setting's mark stands before its control, or before that of a logarithmic slider and its number.
  const isLog = (element) => element?.querySelector(":scope > .hs-log");
  const following = (element, count) => {
    const found = [];
    for (let at = element; at && found.length < count; at = at.nextElementSibling) found.push(at);
    return found;
  };
  const control = (mark) => parts.next(mark).map((next) => (isLog(next) ? next.nextElementSibling : next)).filter(Boolean);
  const has = (such) => (folder) => folder.querySelector(SETTING + such);
  const row = (mark) => following(mark.parentElement, isLog(parts.next(mark)[0]) ? 4 : 2);

  // Words, not changed elements: what the page draws anew is found or hidden in the same way.
  parts.add(
    ["setting", SETTING, parts.up(1)],
    ["of-setting", SETTING, control],
    ["of-setting", ".hs-settings", parts.beside(":scope > .mantine-Flex-root")],
    ["changed", ".hs-changed", control],
    ["restart", ".hs-restart", control],
    ["settings", parts.FOLDER, (end) => parts.up(1)(end).filter(has(""))],
    ["hidden", SETTING, (mark) => (!shown || mark.matches(shown) ? [] : row(mark))],
    ["hidden", parts.FOLDER, (end) => parts.up(1)(end).filter((folder) => shown && has("")(folder) && !has(shown)(folder))],
  );

  function show() {
    const [words, expert, found] = ["input[type=search]", "input[type=checkbox]", "output"]
      .map((part) => document.querySelector(`.hs-find ${part}`));
    const wanted = (words?.value ?? "").trim().split(/\s+/).filter(Boolean);
    const holds = wanted.map((word) => `[data-hs-words*="${CSS.escape(word)}" i]`).join("");
    shown = holds || (expert?.checked ? "" : ":not([data-hs-tier=expert])");
    parts.mark();
    document.documentElement.classList.toggle("hs-finding", wanted.length > 0);
    if (found) found.textContent = holds ? `${document.querySelectorAll(SETTING + holds).length} found` : "";
  }

  document.addEventListener("input", (event) => event.target.closest?.(".hs-find") && show());
  document.addEventListener("click", (event) => {
    const name = event.target.closest?.("[data-hs-reset]")?.dataset.hsReset;
    const uuid = document.querySelector("[data-hs-resets]")?.dataset.hsResets;
    if (name && uuid) window.__viserMutable?.sendMessage?.({ type: "GuiUpdateMessage", uuid, updates: { value: name } });
  });
  show();
})();
