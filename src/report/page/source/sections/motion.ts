import { element } from "../dom.ts";
import type { Section } from "../tools.ts";

export const motion: Section = {
  name: "motion",
  title: "Motion",
  present: (data) => data.motions.length > 0,
  render(host, tools) {
    const place = element("div", { class: "motion" }, element("p", { class: "note" }, "Preparing the view …"));
    host.append(place);
    const failed = (fault: unknown): void => {
      place.replaceChildren(element("p", { class: "fault" }, `The motion cannot be shown here: ${fault instanceof Error ? fault.message : String(fault)}`));
    };
    // loaded on demand; an error does not affect other sections
    import("../motion/motion.ts")
      .then((loaded) => {
        place.replaceChildren();
        loaded.mountMotion(place, tools.data, tools.page);
      })
      .catch(failed);
  },
};
