// A big table: AG Grid with the theme of iX. `rows` for what is all here; `source` for rows that the server has, of which those in sight are asked for.
import { CellStyleModule, ClientSideRowModelModule, createGrid, InfiniteRowModelModule, ModuleRegistry, RenderApiModule, RowApiModule, RowStyleModule, ScrollApiModule, TextEditorModule, type ColDef, type GridApi, type GridOptions, type IGetRowsParams } from "ag-grid-community";
import * as ag_grid from "ag-grid-community";
import { getIxTheme } from "@siemens/ix-aggrid";
import { style_container } from "./style_container.js";

// Each one more costs something in each cell.
ModuleRegistry.registerModules([CellStyleModule, ClientSideRowModelModule, InfiniteRowModelModule, RenderApiModule, RowApiModule, RowStyleModule, ScrollApiModule]);
const theme = getIxTheme(ag_grid).withParams({ fontSize: 13, cellHorizontalPadding: 8, headerFontSize: 13, rowHeight: 28, headerHeight: 32, backgroundColor: "var(--theme-color-1)", oddRowBackgroundColor: "var(--theme-color-1)", headerBackgroundColor: "var(--theme-color-2)" });

/** Rows that are somewhere else. `version` changes whenever rows or their count have; a row that is the same object is the same. */
export interface RowSource<Row> {
  readonly count: number;
  readonly version: number;
  row(index: number): Row | undefined;
  /** These are in sight now. */
  see(first: number, last: number): void;
}

export type Columns<Row> = ColDef<Row>[];

const block = 1000;
const filled_ahead = 150;  // lines above and below those in sight

/** The head of a column of figures stands above them. */
const with_heads = <Row>(columns: Columns<Row>): Columns<Row> => columns.map((one) => (one.cellClass === "figure" ? { ...one, headerClass: "ag-right-aligned-header" } : one));

export class DataGrid<Row = unknown> extends HTMLElement {
  private api: GridApi<Row> | null = null;
  private seen_version = -1;
  private given_rows: readonly Row[] = [];
  private given_columns: Columns<Row> = [];
  label = "";
  empty = "Nothing to show";
  row_id: ((row: Row) => string) | null = null;
  /** By name of a class: which rows have it. */
  row_classes: Record<string, (row: Row) => boolean> = {};
  source: RowSource<Row> | null = null;
  /** Some of its cells are edited. */
  is_edited = false;
  options: GridOptions<Row> = {};
  chosen: ((row: Row) => void) | null = null;
  opened: ((row: Row) => void) | null = null;
  menu: ((row: Row, x: number, y: number) => void) | null = null;
  /** Key p at a row. */
  plotted: ((row: Row) => void) | null = null;
  /** Somebody goes from row to row by the keyboard. */
  moved: (() => void) | null = null;
  /** Key m at a row. */
  marked: ((row: Row) => void) | null = null;

  set columns(columns: Columns<Row>) {
    this.given_columns = columns;
    this.api?.setGridOption("columnDefs", with_heads(columns));
  }

  set rows(rows: readonly Row[]) {
    if (rows === this.given_rows) return;
    this.given_rows = rows;
    this.api?.setGridOption("rowData", rows as Row[]);
  }

  get grid(): GridApi<Row> | null {
    return this.api;
  }

  connectedCallback(): void {
    this.addEventListener("mouseover", (event) => this.name_cut_text(event.target));
    // Lit sets the properties of an element that is new before it is connected, or right behind.
    queueMicrotask(() => { if (this.isConnected && !this.api) this.make(); });
  }

  disconnectedCallback(): void {
    this.api?.destroy();
    this.api = null;
    this.seen_version = -1;
  }

  private make(): void {
    const source = this.source;
    const common: GridOptions<Row> = {
      theme,
      themeStyleContainer: style_container(),
      themeCssLayer: "grid",
      rowHeight: 28,
      headerHeight: 32,
      columnDefs: with_heads(this.given_columns),
      defaultColDef: { sortable: !source, resizable: true, suppressHeaderMenuButton: true, suppressMovable: false },
      suppressDragLeaveHidesColumns: true,
      animateRows: false,
      suppressCellFocus: false,
      ensureDomOrder: true,
      rowBuffer: 4,
      suppressColumnVirtualisation: true,
      overlayNoRowsTemplate: `<span>${this.empty.replace(/[<&]/g, "")}</span>`,
      onRowClicked: (event) => { if (event.data) this.choose(event.data); },
      onRowDoubleClicked: (event) => { if (event.data) this.opened?.(event.data); },
      onCellKeyDown: (event) => {
        const key = (event.event as KeyboardEvent | undefined)?.key;
        if (key === "ArrowDown" || key === "ArrowUp") this.moved?.();
        if (key === "p" && event.data) this.plotted?.(event.data);
        if (key === "m" && event.data) this.marked?.(event.data);
        if (key === "Enter" && event.data && !("colDef" in event && event.colDef.editable)) this.choose(event.data);
      },
      onCellContextMenu: (event) => {
        const mouse = event.event as MouseEvent | null;
        if (!event.data || !this.menu || !mouse) return;
        mouse.preventDefault();
        this.menu(event.data, mouse.clientX, mouse.clientY);
      },
      rowClassRules: Object.fromEntries(Object.entries(this.row_classes).map(([name, has]) => [name, (params: { data: Row | undefined }) => params.data !== undefined && has(params.data)])),
    };
    if (this.row_id) {
      const row_id = this.row_id;
      common.getRowId = (params) => row_id(params.data);
    }
    if (source) {
      Object.assign(common, {
        rowModelType: "infinite", cacheBlockSize: block, maxBlocksInCache: 4, infiniteInitialRowCount: Math.max(1, source.count), blockLoadDebounceMillis: 30,
        datasource: { getRows: (params: IGetRowsParams) => this.give_rows(params) },
        onViewportChanged: (event: { firstRow: number; lastRow: number }) => {
          if (event.lastRow < 0) return;
          source.see(event.firstRow, event.lastRow);
          this.fill();
        },
      });
    } else {
      common.rowData = this.given_rows as Row[];
    }
    this.api = createGrid<Row>(this, { ...common, ...this.options }, { modules: this.is_edited ? [TextEditorModule] : [] });
    if (this.label) this.api.setGridAriaProperty("label", this.label);
  }

  /** Text that is cut off is shown by the browser where the mouse rests. */
  private name_cut_text(target: EventTarget | null): void {
    const cell = target instanceof HTMLElement ? target.closest<HTMLElement>(".ag-cell") : null;
    if (cell && !cell.querySelector("[title]")) cell.title = cell.scrollWidth > cell.clientWidth ? (cell.textContent ?? "") : "";
  }

  private give_rows(params: IGetRowsParams): void {
    const source = this.source;
    if (!source) return params.failCallback();
    const rows: (Row | undefined)[] = [];
    for (let index = params.startRow; index < Math.min(params.endRow, source.count); ++index) rows.push(source.row(index));
    params.successCallback(rows, source.count);
  }

  /** Called with each drawing: what has changed in the source is shown. */
  update(): void {
    if (!this.api || !this.source || this.source.version === this.seen_version) return;
    this.seen_version = this.source.version;
    if (this.api.getDisplayedRowCount() !== this.source.count) this.api.setRowCount(this.source.count, true);
    this.fill();
    this.api.refreshCells();  // those that depend on something beside their row
    if (this.source.count === 0) this.api.showNoRowsOverlay();
    else this.api.hideOverlay();
  }

  /** Lines in sight get the rows of now, and so do those that come into sight next: a line that is drawn empty is drawn twice. The grid would fetch all its blocks anew and draw each line again. */
  private fill(): void {
    const { api, source } = this;
    if (!api || !source) return;
    const [first, last] = [api.getFirstDisplayedRowIndex(), api.getLastDisplayedRowIndex()];
    for (let index = Math.max(0, first - filled_ahead); index <= Math.min(source.count - 1, last + filled_ahead); ++index) {
      const node = api.getDisplayedRowAtIndex(index);
      const row = source.row(index);
      if (!node || row === node.data) continue;
      if (index < first || index > last) node.data = row;  // nothing is drawn
      else if (row) node.updateData(row);
      else node.setData(undefined as Row);
    }
  }

  show_index(index: number, place: "top" | "bottom" | "middle" | null = null): void {
    if (this.api && index >= 0) this.api.ensureIndexVisible(index, place);
  }

  private choose(row: Row): void {
    this.chosen?.(row);
    this.redraw();
  }

  /** What a row looks like depends on something beside its data, which has changed. */
  redraw(): void {
    for (const node of this.api?.getRenderedNodes() ?? []) {
      const { data } = node;
      if (!data) continue;
      for (const line of this.querySelectorAll(`.ag-row[row-index="${node.rowIndex}"]`)) for (const [name, has] of Object.entries(this.row_classes)) line.classList.toggle(name, has(data));
    }
  }
}

customElements.define("data-grid", DataGrid);
