// A big table: AG Grid with the theme of iX. `rows` for what is all here; `source` for rows that the server has, of which those in sight are asked for.
import { AllCommunityModule, createGrid, ModuleRegistry, type ColDef, type GridApi, type GridOptions, type IGetRowsParams } from "ag-grid-community";
import * as ag_grid from "ag-grid-community";
import { getIxTheme } from "@siemens/ix-aggrid";
import { style_container } from "./style_container.js";

ModuleRegistry.registerModules([AllCommunityModule]);
const theme = getIxTheme(ag_grid).withParams({ fontSize: 13, cellHorizontalPadding: 8, headerFontSize: 13, rowHeight: 28, headerHeight: 32 });

/** Rows that are somewhere else. `version` changes whenever rows or their count have. */
export interface RowSource<Row> {
  readonly count: number;
  readonly version: number;
  row(index: number): Row | undefined;
  /** These are in sight now. */
  see(first: number, last: number): void;
}

export type Columns<Row> = ColDef<Row>[];

const block = 100;

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
  options: GridOptions<Row> = {};
  chosen: ((row: Row) => void) | null = null;
  opened: ((row: Row) => void) | null = null;
  menu: ((row: Row, x: number, y: number) => void) | null = null;
  scrolled: ((by_hand: boolean) => void) | null = null;

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
      enableCellTextSelection: true,
      ensureDomOrder: true,
      tooltipShowDelay: 400,
      overlayNoRowsTemplate: `<span>${this.empty.replace(/[<&]/g, "")}</span>`,
      onRowClicked: (event) => { if (event.data) this.choose(event.data); },
      onRowDoubleClicked: (event) => { if (event.data) this.opened?.(event.data); },
      onCellKeyDown: (event) => {
        const key = (event.event as KeyboardEvent | undefined)?.key;
        if (key === "Enter" && event.data && !("colDef" in event && event.colDef.editable)) this.choose(event.data);
      },
      onCellContextMenu: (event) => {
        const mouse = event.event as MouseEvent | null;
        if (!event.data || !this.menu || !mouse) return;
        mouse.preventDefault();
        this.menu(event.data, mouse.clientX, mouse.clientY);
      },
      onBodyScroll: (event) => { if (event.direction === "vertical") this.scrolled?.(true); },
      rowClassRules: Object.fromEntries(Object.entries(this.row_classes).map(([name, has]) => [name, (params: { data: Row | undefined }) => params.data !== undefined && has(params.data)])),
    };
    if (this.row_id) {
      const row_id = this.row_id;
      common.getRowId = (params) => row_id(params.data);
    }
    if (source) {
      Object.assign(common, {
        rowModelType: "infinite", cacheBlockSize: block, maxBlocksInCache: 6, infiniteInitialRowCount: Math.max(1, source.count), blockLoadDebounceMillis: 30,
        datasource: { getRows: (params: IGetRowsParams) => this.give_rows(params) },
        onViewportChanged: (event: { firstRow: number; lastRow: number }) => { if (event.lastRow >= 0) this.source?.see(event.firstRow, event.lastRow); },
      });
    } else {
      common.rowData = this.given_rows as Row[];
    }
    this.api = createGrid<Row>(this, { ...common, ...this.options });
    if (this.label) this.api.setGridAriaProperty("label", this.label);
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
    this.api.refreshInfiniteCache();
    if (this.source.count === 0) this.api.showNoRowsOverlay();
    else this.api.hideOverlay();
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
