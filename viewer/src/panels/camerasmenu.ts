import type { Components } from "../model/components";
import { h } from "../ui/dom";
import type { Images } from "./images";

/** Maximum number of cameras in the menu; the others are opened from their robot. */
const MOST = 24;

/** Selects the displayed images: of the selected robot, and of single cameras. */
export function camerasMenu(images: Images, components: Components): HTMLElement {
  const follow = h("input", { type: "checkbox", onchange: () => images.follows.set(follow.checked) });
  images.follows.watch((follows) => (follow.checked = follows));
  const list = h("div", {});
  const element = h(
    "fieldset",
    { class: "cameras", hidden: true },
    h("legend", {}, "pictures of cameras"),
    h("label", { class: "switch" }, follow, "of the selected robot"),
    list,
  );
  const show = (): void => {
    const cameras = components.cameras.slice(0, MOST);
    element.hidden = cameras.length === 0;
    list.replaceChildren(
      ...cameras.map(({ name }) => {
        const box = h("input", { type: "checkbox", checked: images.open.value.includes(name), onchange: () => images.toggle(name) });
        return h("label", { class: "switch" }, box, h("span", { class: "dot", style: `--ink: ${components.colorOf(name)}` }), name);
      }),
    );
  };
  components.all.watch(show);
  images.open.watch((open) => {
    // in place: a check box keeps the focus
    components.cameras.slice(0, MOST).forEach(({ name }, i) => {
      const box = list.children[i]?.querySelector("input");
      if (box) box.checked = open.includes(name);
    });
  });
  return element;
}
