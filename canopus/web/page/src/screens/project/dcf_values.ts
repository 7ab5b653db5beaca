// The values of a DCF beside those of a node of the project; they are taken over only after a look at them.
import { html, nothing, type TemplateResult } from "lit";
import type { App } from "../../frame/app.js";
import { device_file_types, largest_device_file } from "../../parts/device_files.js";
import { count_text } from "../../store/nodes.js";
import type { Project } from "../../store/project.js";

interface Difference {
  object: string;
  name?: string;
  project?: unknown;
  dcf?: unknown;
  state?: string;
}

export class DcfValues {
  private node = 0;
  private file: { name: string; text: string } | null = null;
  private rows: Difference[] = [];

  constructor(private readonly app: App) {}

  close(): void {
    this.file = null;
    this.rows = [];
  }

  private async compare(project: Project, node: number, chosen: File): Promise<void> {
    this.close();
    if (chosen.size > largest_device_file) return this.app.say(`${chosen.name} is larger than 1.5 MB, which is too large for the page`, "error");
    const file = { name: chosen.name, text: await chosen.text() };
    const done = await this.app.run({ command: "project dcf compare", bus: project.bus.bus, node: String(node), file }, { fine: [0, 4], done: "" });
    if (done.failed) return;
    const rows = done.rows.filter((row) => row["object"] !== undefined) as unknown as Difference[];
    if (rows.length === 0) return this.app.say(`${file.name} has the values of the project`);
    Object.assign(this, { node, file, rows });
    this.app.redraw();
  }

  button(project: Project, node: number, off: boolean): TemplateResult {
    return html`<label class="quiet bordered file">Compare DCF …<input type="file" accept=${device_file_types} ?disabled=${off} @change=${(event: Event) => { const input = event.target as HTMLInputElement; const [file] = input.files ?? []; if (file) void this.compare(project, node, file).then(() => { input.value = ""; }); }}></label>`;
  }

  view(project: Project, node: number): TemplateResult | typeof nothing {
    const { file } = this;
    if (!file || node !== this.node) return nothing;
    const shut = (): void => { this.close(); this.app.redraw(); };
    return html`<div class="panel"><h2>${file.name}: ${count_text(this.rows.length, "difference")}</h2><div class="scrolls short" tabindex="0" role="region" aria-label=${`Values of ${file.name}`}><table class="rows"><thead><tr><th scope="col">Object</th><th scope="col">Name</th><th scope="col">Project</th><th scope="col">File</th></tr></thead>
        <tbody>${this.rows.map((row) => html`<tr><th scope="row">${row.object}</th><td>${row.name ?? ""}</td><td>${String(row.project ?? "")}</td><td>${String(row.dcf ?? "")}</td></tr>`)}</tbody></table></div>
      <p class="buttons"><ix-button @click=${async () => { const done = await this.app.change(project, { command: "project dcf load", node: String(node), file }, `the node has the values of ${file.name}`); if (!done.failed) shut(); }}>Take over these values</ix-button><ix-button variant="secondary" @click=${shut}>Cancel</ix-button></p></div>`;
  }
}
