// The buttons of the list of runs: what they ask for goes to the server as words, and is checked there.
"use strict";

(() => {
  const LONGEST = 60; // characters of a name

  // A name is asked for where one is given; without an answer nothing is done.
  function words({ hsRun, hsName }) {
    if (!hsRun.startsWith("rename:")) return hsRun;
    const name = prompt("The name of this run:", hsName);
    return name === null ? null : hsRun + name.slice(0, LONGEST);
  }

  document.addEventListener("click", (event) => {
    const button = event.target.closest?.("[data-hs-run]");
    const uuid = document.querySelector("[data-hs-runs]")?.dataset.hsRuns;
    const value = button && uuid ? words(button.dataset) : null;
    if (value) window.__viserMutable?.sendMessage?.({ type: "GuiUpdateMessage", uuid, updates: { value } });
  });
})();
