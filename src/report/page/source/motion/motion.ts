import type { PageContext } from "../context.ts";
import type { ReportData } from "../data.ts";

/** Stands in until the viewer is there. */
export function mountMotion(host: HTMLElement, _data: ReportData, _page: PageContext): void {
  host.textContent = "the motion view is not there";
}
