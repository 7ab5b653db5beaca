// The button that submits a form.
import { html, nothing, type TemplateResult } from "lit";

/**
 * Enter in a field submits the form through a button of HTML, not through the one that iX puts into `ix-button type=submit`: iX draws its `disabled` a frame
 * late, and an Enter right behind the last character was lost. The form's handler checks what it needs itself.
 */
export function submit_button(label: string, { id = "", disabled = false }: { id?: string; disabled?: boolean } = {}): TemplateResult {
  return html`<button type="submit" class="hidden" tabindex="-1" aria-hidden="true"></button><ix-button id=${id || nothing} ?disabled=${disabled} @click=${(event: Event) => (event.currentTarget as HTMLElement).closest("form")?.requestSubmit()}>${label}</ix-button>`;
}
