import { element } from "../dom.ts";
import { mountLessons } from "../lesson/lesson.ts";
import type { Section } from "../tools.ts";

export const lessons: Section = {
  name: "lessons",
  title: "Live lessons",
  present: (data) => data.lessons.length > 0,
  render(host, tools) {
    if (!tools.data.lesson_page) host.append(element("p", { class: "explain" }, "The page computes these motions itself: move the sliders and compare an update of a game or a textbook with the truth."));
    const place = element("div");
    host.append(place);
    mountLessons(place, tools.data, tools.page);
  },
};
