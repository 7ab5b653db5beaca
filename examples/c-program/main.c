/* A tank that a pump fills: a PLC program in C, run once a scan. README.md says how to build it. */
#include <canopus_program.h>

static uint8_t start_button; /* X10 */
static uint8_t stop_button;  /* X11 */
static uint8_t pump;         /* Y20 */
static float level;          /* m */
static float limit = 2.5F;
static uint32_t fillings;
static int64_t running_time;

static int64_t last_scan;
static int has_scanned;

static void start(void) { has_scanned = 0; }

static const char *scan(const canopus_image *image, int64_t now_ns) {
  (void)image;
  const int64_t step = has_scanned ? now_ns - last_scan : 0;
  last_scan = now_ns;
  has_scanned = 1;

  if (limit <= 0.0F) return "the limit of the level is not above 0";
  if (start_button && !pump) {
    pump = 1;
    ++fillings;
  }
  if (pump) {
    running_time += step;
    level += 0.1F * (float)step / 1e9F; /* 0.1 m in a second */
  }
  if (stop_button || level >= limit) pump = 0;
  return 0;
}

static const canopus_variable variables[] = {
    {"start_button", CANOPUS_BOOL, 0, 0, CANOPUS_INPUT, &start_button, "X10"},
    {"stop_button", CANOPUS_BOOL, 0, 0, CANOPUS_INPUT, &stop_button, "X11"},
    {"pump", CANOPUS_BOOL, 0, 0, CANOPUS_OUTPUT, &pump, "Y20"},
    {"level", CANOPUS_REAL, 0, 0, CANOPUS_OUTPUT, &level, "D100"},
    {"limit", CANOPUS_REAL, 0, 0, 0, &limit, 0},
    {"fillings", CANOPUS_UDINT, 0, 0, CANOPUS_RETAIN, &fillings, 0},
    {"running_time", CANOPUS_TIME, 0, 0, CANOPUS_RETAIN, &running_time, 0},
};

static const canopus_program_info info = {
    CANOPUS_PROGRAM_ABI, sizeof variables / sizeof *variables, variables, start, scan,
};

const canopus_program_info *canopus_program(void) { return &info; }
