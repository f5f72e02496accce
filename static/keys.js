// What was clicked keeps the keyboard, and the hotkeys would act on it: a space would tick a box again instead of
// playing. So it lets go, unless something is typed there. Whoever moves about by the keyboard keeps the focus.
"use strict";

(() => {
  const CHOSEN = "[role=option]";
  const SETTLED = 100; // milliseconds: a list takes the focus back as it closes
  const CLICKED = "button, [role=tab], input[type=checkbox], input[type=radio]";

  document.addEventListener("click", (event) => {
    if (event.detail === 0) return; // of a key
    const chosen = event.target.closest?.(CHOSEN);
    setTimeout(() => {
      const at = document.activeElement;
      if (chosen || at?.matches(CLICKED)) at?.blur();
    }, SETTLED);
  }, true);
})();
