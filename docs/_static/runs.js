// Recorded runs are loaded while they are seen: each of them draws a world, and a browser draws few at once.
const seen = new IntersectionObserver((entries) => {
  for (const { target, isIntersecting } of entries) {
    if (isIntersecting === target.hasAttribute("src")) continue;
    if (isIntersecting) {
      target.src = target.dataset.src;
      continue;
    }
    // a new frame instead of an empty page in the old one, which would be an entry of the history
    const empty = target.cloneNode();
    empty.removeAttribute("src");
    target.replaceWith(empty);
    seen.unobserve(target);
    seen.observe(empty);
  }
});
for (const frame of document.querySelectorAll(".run iframe")) seen.observe(frame);
