// How a person turns, moves and zooms the formed part: pointer, fingers, wheel, keys.
"use strict";
(function () {
  const TURN = 0.0087, STEP = 0.14, ZOOM = 1.2, PAN = 20;   // rad a px, rad a key, a key or notch, px a key

  const local = (canvas, event) => { const box = canvas.getBoundingClientRect(); return [event.clientX - box.left, event.clientY - box.top]; };

  // view: { orbit(around, over), pan(x, y), zoom(by, at), reset(), hover(at | null) }; signal ends it.
  function listen(canvas, view, signal) {
    const on = (name, call) => canvas.addEventListener(name, call, { signal, passive: false });
    const held = new Map(), at = (event) => local(canvas, event);
    on("pointerdown", (event) => { canvas.setPointerCapture(event.pointerId); held.set(event.pointerId, { at: at(event), moved: false }); canvas.style.cursor = "grabbing"; });
    on("pointermove", (event) => held.has(event.pointerId) ? drag(view, held, event, at(event)) : view.hover(at(event)));
    const release = (event) => {
      if (event.type === "pointerup" && held.get(event.pointerId)?.moved === false) view.hover(at(event));
      held.delete(event.pointerId);
      canvas.style.cursor = "grab";
    };
    for (const name of ["pointerup", "pointercancel"]) on(name, release);
    on("pointerleave", () => view.hover(null));
    on("contextmenu", (event) => event.preventDefault());
    on("dblclick", () => view.reset());
    on("wheel", (event) => { event.preventDefault(); view.zoom(ZOOM ** (-Math.sign(event.deltaY) / 2), at(event)); });
    on("keydown", (event) => key(view, event));
  }

  function drag(view, held, event, now) {
    const mine = held.get(event.pointerId), before = mine.at;
    mine.at = now;
    const by = [now[0] - before[0], now[1] - before[1]];
    mine.moved = mine.moved || Math.hypot(...by) > 0;
    const other = [...held].find(([id]) => id !== event.pointerId)?.[1].at;
    if (other) {
      const far = (place) => Math.max(Math.hypot(place[0] - other[0], place[1] - other[1]), 1);
      view.zoom(far(now) / far(before), now.map((x, k) => (x + other[k]) / 2));
      view.pan(by[0] / 2, by[1] / 2);
    } else if (event.shiftKey || event.buttons & 6) view.pan(...by);
    else view.orbit(-TURN * by[0], TURN * by[1]);
  }

  function key(view, event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const arrow = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (arrow && event.shiftKey) view.pan(-PAN * arrow[0], PAN * arrow[1]);
    else if (arrow) view.orbit(STEP * arrow[0], STEP * arrow[1]);
    else if (event.key === "+" || event.key === "=") view.zoom(ZOOM);
    else if (event.key === "-") view.zoom(1 / ZOOM);
    else if (event.key === "Home" || event.key === "0") view.reset();
    else return;
    event.preventDefault();
  }

  window.planishHands = { listen };
})();
