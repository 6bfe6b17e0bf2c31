// A program with CycloneDDS 0.10 (Debian 12, Ubuntu, the line of ROS Humble to Jazzy): prints how
// many publishers of a topic it sees, whenever that changes. Ends when its standard input closes.
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "dds/dds.h"

enum { MOST = 256 };

static int publishers (dds_entity_t reader, const char *topic)
{
  void *samples[MOST] = { NULL };
  dds_sample_info_t infos[MOST];
  int found = 0;
  int count = dds_read_mask (reader, samples, infos, MOST, MOST, DDS_ALIVE_INSTANCE_STATE);
  for (int i = 0; i < count; i++)
  {
    const dds_builtintopic_endpoint_t *endpoint = samples[i];
    found += infos[i].valid_data && strcmp (endpoint->topic_name, topic) == 0;
  }
  if (count > 0)
    dds_return_loan (reader, samples, count);
  return found;
}

int main (int count, char **arguments)
{
  if (count != 3)
    return 2;
  dds_entity_t participant = dds_create_participant (atoi (arguments[1]), NULL, NULL);
  dds_entity_t reader = dds_create_reader (participant, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, NULL, NULL);
  if (reader < 0)
    return 1;
  struct pollfd input = { .fd = 0, .events = POLLIN };
  int before = -1;
  while (poll (&input, 1, 20) == 0)
  {
    int now = publishers (reader, arguments[2]);
    if (now != before)
    {
      printf ("%d\n", now);
      fflush (stdout);
    }
    before = now;
  }
  dds_delete (participant);
  return 0;
}
