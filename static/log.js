// A click on a time in the log goes there.
"use strict";

document.addEventListener("click", (event) => {
  const line = event.target.closest?.("[data-hs-seconds]");
  if (line) window.hectorscope.timeline?.seek(Number(line.dataset.hsSeconds));
});
