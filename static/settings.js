// The settings: each browser finds them by words, and shows those of experts or not. A button resets one of them.
"use strict";

(() => {
  const SETTING = ".hs-setting";
  const rules = new CSSStyleSheet();
  document.adoptedStyleSheets = [...document.adoptedStyleSheets, rules];

  // Rules, not changed elements: what the page draws anew is found or hidden in the same way.
  function hidden(shown) {
    const other = `${SETTING}:not(${shown})`;
    const mark = `div:has(> ${other})`;
    const folder = ".mantine-Paper-root:has(> .mantine-Paper-root + div + div)";
    return `:root:root:root :is(${mark}, ${mark} + div, ${mark} + div:has(> .hs-log) + div, ${mark} + div:has(> .hs-log) + div + div,
      ${folder}:has(${SETTING}):not(:has(${SETTING}${shown}))) { display: none !important; }`;
  }

  function show() {
    const [words, expert, found] = ["input[type=search]", "input[type=checkbox]", "output"]
      .map((part) => document.querySelector(`.hs-find ${part}`));
    const wanted = (words?.value ?? "").trim().split(/\s+/).filter(Boolean);
    const holds = wanted.map((word) => `[data-hs-words*="${CSS.escape(word)}" i]`).join("");
    const shown = holds || (expert?.checked ? "" : ":not([data-hs-tier=expert])");
    rules.replaceSync(shown ? hidden(shown) : "");
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
