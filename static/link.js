// The link to the server: shows when that is silent and how old the picture is, and opens the page again once the
// server can be had again. viser by itself tries every second, and each try ends the one before: where a connection
// takes longer than that, as after a long break, none ever comes about.
"use strict";

(() => {
  const FIRST = 20; // seconds until the first heartbeat, at most
  const SILENT = 4; // seconds without a heartbeat, which comes every second
  const ANEW = 8;
  const PATIENCE = 3000; // milliseconds for an answer

  let heard = null; // nothing yet: the page has just been opened
  let since = performance.now(); // when it was opened or came to the front
  let asking = false;
  function beat() {
    heard = performance.now();
    document.documentElement.classList.remove("hs-silent");
  }

  async function look() {
    if (document.hidden) return;
    const silent = (performance.now() - (heard ?? since)) / 1000;
    if (silent < (heard === null ? FIRST : SILENT)) return;
    const age = heard === null ? "Nothing came since the page was opened." : `The picture is ${Math.round(silent)} s old.`;
    const detail = `${age} Check that the program runs and the network holds.`;
    window.hectorscope.tell?.({ kind: "error", symbol: "✕", title: "No message from the server", detail });
    document.documentElement.classList.add("hs-silent");
    if (heard === null || silent < ANEW || asking) return; // viser goes on trying to make a first connection
    asking = true;
    const answer = await fetch("healthz", { cache: "no-store", signal: AbortSignal.timeout(PATIENCE) }).catch(() => null);
    asking = false;
    if (answer?.ok && performance.now() - heard > 1000 * SILENT) location.reload();
  }

  // A page in the background hears nothing and misses nothing.
  document.addEventListener("visibilitychange", () => {
    since = performance.now();
    if (heard !== null) beat();
  });
  setInterval(look, 1000);
  window.hectorscope = Object.assign(window.hectorscope ?? {}, { beat });
})();
