// A click on a time in the log moves the timeline to it, as a hand would: the server bounds it in the same way.
"use strict";

document.addEventListener("click", (event) => {
  const line = event.target.closest?.("[data-hs-seconds]");
  const timeline = document.querySelector("[data-hs-timeline]");
  if (!line || !timeline) return;
  const value = Number(line.dataset.hsSeconds);
  window.__viserMutable?.sendMessage?.({ type: "GuiUpdateMessage", uuid: timeline.dataset.hsTimeline, updates: { value } });
});
