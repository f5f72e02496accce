// A closer look at a beam or a cell that was clicked: a card over the scene, and marks on the map. The server works it
// out for the shown scan (panels/closer.py), for this browser alone. Escape closes the card; B looks at the beam ahead.
"use strict";

(() => {
  const hectorscope = window.hectorscope;
  const { pick } = hectorscope;
  const card = document.createElement("section");
  card.className = "hs-closer";
  card.setAttribute("aria-label", "Closer look");
  card.hidden = true;
  card.innerHTML = '<button type="button" class="hs-tool hs-closer-close" title="Close · Escape" aria-label="Close"><svg viewBox="0 0 24 24"><path d="M6 6l12 12M18 6 6 18"/></svg></button><div aria-live="polite"></div>';
  document.body.append(card);
  const [close, content] = card.children;
  let byKey = false; // the card that comes is to have the focus

  function place() {
    const canvas = window.__viserMutable?.canvas?.getBoundingClientRect();
    if (canvas?.width) Object.assign(card.style, { left: `${canvas.left + 12}px`, bottom: `${innerHeight - canvas.bottom + 12}px`, maxHeight: `${canvas.height - 24}px` });
  }

  // Content and marks from the server; nothing closes the card. What has the focus keeps it.
  function show(html, marks) {
    if (html && content.innerHTML !== html) {
      const beam = content.contains(document.activeElement) && document.activeElement.dataset.hsBeam;
      content.innerHTML = html;
      if (beam) content.querySelector(`[data-hs-beam="${beam}"]`)?.focus();
    }
    card.hidden = !html;
    if (html) place();
    if (html && byKey) close.focus();
    byKey = byKey && !html;
    const [beam, cell] = [marks?.beam, marks?.cell];
    pick.mark("beam", beam && (() => pick.line("beam", [[0, beam[0], beam[1]], [0, beam[2], beam[3]]])));
    pick.mark("cell", cell && (() => {
      const [level, x, y, side] = cell;
      return pick.line("cell", [[level, x, y], [level, x + side, y], [level, x + side, y + side], [level, x, y + side]]);
    }));
  }

  function away() {
    show();
    hectorscope.request("look", {});
  }

  // The beam that looks ahead is the middle one: a start for those who use the keyboard.
  function ahead() {
    byKey = true;
    hectorscope.request("look", { beam: -1 });
  }

  content.addEventListener("click", ({ target }) => {
    const step = target.closest("[data-hs-beam]")?.dataset.hsBeam;
    const number = Number(content.querySelector("[data-hs-number]")?.dataset.hsNumber);
    if (step && Number.isInteger(number)) hectorscope.request("look", { beam: Math.max(0, number + Number(step)) });
  });
  close.addEventListener("click", away);
  document.addEventListener("keydown", (event) => {
    if (event.key === "Escape" && !card.hidden && !document.querySelector("dialog[open]")) away();
  });
  addEventListener("resize", place);
  new MutationObserver(() => requestAnimationFrame(place)).observe(document.documentElement, { attributeFilter: ["data-hs-panels", "data-hs-plots"] });
  pick.listen(({ clientX, clientY }) => {
    hectorscope.request("look", { at: pick.places(clientX, clientY), reach: pick.reach(clientX, clientY) });
  });

  Object.assign(hectorscope, { closer: { show, ahead } });
})();
