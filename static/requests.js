// What a script asks of the server: JSON in a hidden text field, which the server checks (panels/_request.py).
"use strict";

(() => {
  let count = 0; // makes each request another value: the server hears changes only

  function request(name, wanted) {
    const field = document.querySelector(`[data-hs-request="${name}"]`)?.dataset.hsField;
    count += 1;
    const value = JSON.stringify({ ...wanted, count, page: window.hectorscope.pageNumber });
    if (field) window.__viserMutable?.sendMessage?.({ type: "GuiUpdateMessage", uuid: field, updates: { value } });
  }

  const AGAIN = 1000; // milliseconds

  // Asks by a button until the returned function is called: before the first word of a page's camera, the server hears
  // nothing else that it says.
  function ask(uuid) {
    const send = () => window.__viserMutable?.sendMessage?.({ type: "GuiUpdateMessage", uuid, updates: { value: true } });
    const asking = setInterval(send, AGAIN);
    send();
    return () => clearInterval(asking);
  }

  Object.assign(window.hectorscope, { ask, request, pageNumber: Math.random() });
})();
