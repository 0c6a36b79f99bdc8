import type { Connection } from "../connection/connection";
import type { ServiceDescription } from "../generated/protocol";
import { h } from "../ui/dom";
import { format, parse } from "./values";

/** A service with fields for its arguments, a button that calls it, and its result. */
export function serviceForm(connection: Connection, component: string, service: ServiceDescription): HTMLElement {
  const inputs = service.arguments.map(({ name, type, default: preset }) =>
    h("input", { placeholder: preset === null ? name : `${name} = ${preset}`, "aria-label": name, title: type, required: preset === null, spellcheck: false }),
  );
  const result = h("output", { class: "result", hidden: true });
  const call = h("button", { type: "submit" }, "call");
  const cancel = h("button", { type: "button", hidden: true }, "stop");
  let running = 0;

  const run = async (): Promise<void> => {
    const values = inputs.map((input, i) => (input.value === "" ? null : parse(input.value, service.arguments[i]?.type ?? "")));
    // empty arguments at the end use their defaults
    while (values.length > 0 && values.at(-1) === null && inputs[values.length - 1]?.value === "") values.pop();
    const answer = connection.request({ type: "call_service", component, service: service.name, arguments: values });
    running = connection.lastRequest;
    call.disabled = true;
    cancel.hidden = !service.asynchronous;
    result.hidden = true;
    const { ok, value, error } = await answer;
    call.disabled = false;
    cancel.hidden = true;
    result.hidden = false;
    result.classList.toggle("error", !ok);
    result.textContent = ok ? (value === null ? "done" : format(value)) : error;
    result.title = ok ? JSON.stringify(value) : "";
  };
  cancel.addEventListener("click", () => connection.send({ type: "cancel_service", request: running }));
  const form = h("form", { class: "service", "aria-label": service.name }, h("div", { class: "name", title: service.doc }, service.name), ...inputs, call, cancel, result);
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    void run();
  });
  return form;
}
